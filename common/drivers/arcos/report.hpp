// What a Pioneer's packets mean to others: values by name, and faults.
#pragma once

#include <optional>
#include <vector>

#include "common/drivers/arcos/state.hpp"
#include "common/drivers/arcos/syntax.hpp"
#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// One field as it is, several as a list.
RobotValue arcos_value(const std::vector<ArcosField>& fields, const ArcosSip& sip, const ArcosOdometry& place, Now now);

/// The cause of a fault that takes the robot: it is over with the motors on and the STOP button up.
constexpr const char* kArcosHalted = "halted";

/// Stalls and bumpers (URGENT), motors that went off by themselves (CRITICAL), the STOP button (FATAL).
class ArcosFaults {
 public:
  /// A fault, if something is wrong that was not before. `motors_wanted`: they should be on by now.
  std::optional<FaultSaid> hear(const ArcosSip& sip, bool motors_wanted);
  void begin_again() { known_ = 0; }

 private:
  std::uint32_t known_ = 0;  ///< bits of what is wrong
};

/// Why the robot moves no more: "the STOP button is pressed"; empty if it does.
std::string arcos_hindrance(const ArcosSip& sip);

}  // namespace trb::drivers
