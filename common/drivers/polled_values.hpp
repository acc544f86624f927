// The values that are polled from a robot: the last result of each.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/drivers/driver.hpp"
#include "common/fleet/description.hpp"

namespace trb::drivers {

/// The names of values that requests and the description's faults, sensors and ends of skills need.
std::vector<std::string> needed_values(const VendorCommands& vendor, const Description& description);

/// How long the stop that ends a command is held before the release follows, if commands.json does not tell: longer
/// than a program's cycle.
constexpr double kHold_s = 0.5;
double hold_s(const VendorCommands& vendor);

/// The base of a robot's rounds of polling.
class PolledValues {
 public:
  struct Changes {
    bool values = false;
    struct Problem {
      std::string name;
      Error why;
      std::string shared;  ///< what it has in common with the other values of its request; empty: nothing
    };
    std::vector<Problem> problems;  ///< each is reported once, until the value is received again

    void report(const DriverOut& out) const;
  };

  /// nullptr: it is not polled, not received yet, or lost.
  [[nodiscard]] const RobotValue* value(std::string_view name) const;
  /// Why there is no value, if the robot has reported a reason.
  [[nodiscard]] std::optional<Error> problem(std::string_view name) const;

 protected:
  void keep(const std::string& name, RobotValue value, Changes& changes);
  /// `shared`: the part of the problem that all values of the request have; they are one fault.
  void lose(const std::string& name, const Error& problem, Changes& changes, const std::string& shared = {});
  /// Not worth a fault yet.
  void lose_quietly(const std::string& name, const Error& problem) { known_[name] = {{}, problem, false}; }
  /// As if it had never been received.
  void erase(const std::string& name) { known_.erase(name); }
  /// No value is known any more. A problem that persists is not reported again.
  void drop_values();

 private:
  struct Known {
    std::optional<RobotValue> value;
    std::optional<Error> problem;  ///< why there is no value
    bool told = true;              ///< the problem is reported
  };

  std::map<std::string, Known, std::less<>> known_;
};

}  // namespace trb::drivers
