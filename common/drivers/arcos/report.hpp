// Reports from a Pioneer's packets: values by name, and faults.
#pragma once

#include <optional>
#include <vector>

#include "common/drivers/arcos/state.hpp"
#include "common/drivers/arcos/syntax.hpp"
#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// A single field as a value, several as a list.
RobotValue arcos_value(const std::vector<ArcosField>& fields, const ArcosSip& sip, const ArcosOdometry& place, Now now);

/// The cause of a fault of the whole robot: it ends with the motors on and the STOP button up.
constexpr const char* kArcosHalted = "halted";

/// Stalls and bumpers (URGENT), motors that went off by themselves (CRITICAL), the STOP button (FATAL).
class ArcosFaults {
 public:
  /// A fault, if there is a new one. `motors_wanted`: they should be on by now.
  std::optional<FaultSaid> update(const ArcosSip& sip, bool motors_wanted);
  void begin_again() { known_ = 0; }

 private:
  std::uint32_t known_ = 0;  ///< bits of the current faults
};

/// Why the robot cannot move: "the STOP button is pressed"; empty if it can.
std::string arcos_hindrance(const ArcosSip& sip);

}  // namespace trb::drivers
