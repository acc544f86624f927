// A robot's battery, position and mode from the values that it sends: only this file knows their names and units.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/fleet/charge.hpp"
#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// State of charge in percent. `state_of_charge` is percent for every robot and has priority; `battery` depends on the
/// transport:
///   ros       a fraction, 0 to 1 (sensor_msgs/BatteryState)
///   udp-at    percent (navdata)
///   fields    percent, as config/robots/README.md requires of user-programmed robots
///   others    in volts (ARCOS), or not defined: unknown
/// Also unknown: a value out of its range, not a number, or of another kind.
[[nodiscard]] std::optional<Reported<double>> charge_of(const RobotRecord& robot);

/// Where the robot is. A robot that drives or flies (capability `mobile` or `fly`) sends it as `position`: [x, y, ...],
/// {"x", "y"} or words "x y ..." in its own frame and unit, which its node's profile relates to the hall. Any other
/// robot stands at its description's origin. Unknown: no origin, or the node does not report its frame.
[[nodiscard]] std::optional<Reported<HallPoint>> position_of(const RobotRecord& robot);

/// The operating mode in the robot's own words: the first that it sends of operating_mode, robot_mode, mode, state.
[[nodiscard]] std::optional<Reported<std::string>> mode_of(const RobotRecord& robot);

/// A value that the robot sends as a number, {"NAME": number} or plain words. Unknown: it sends none, or anything else.
[[nodiscard]] std::optional<Reported<double>> number_of(const RobotRecord& robot, std::string_view name);

}  // namespace trb::resilience
