// A robot's battery, position and mode out of the values that it sends: the one place that knows their names and units.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// State of charge in percent. `state_of_charge` is percent of every robot and wins; `battery` is, by the robot's way:
///   ros       a fraction, 0 to 1 (sensor_msgs/BatteryState)
///   udp-at    percent (navdata)
///   fields    percent, as config/robots/README.md asks of a robot that one programs
///   others    in volts (ARCOS), or nobody knows: unknown
/// Unknown too: a value out of its range, not a number, or of another kind.
[[nodiscard]] std::optional<Reported<double>> charge_of(const RobotRecord& robot);

/// Where the robot is. A robot that drives or flies (capability `mobile` or `fly`) tells it as `position`: [x, y, ...],
/// {"x", "y"} or words "x y ..." in its own frame and unit, which its node's profile relates to the hall. Any other
/// stands where its description puts its origin; one without an origin, or of a node that does not tell its frame:
/// unknown.
[[nodiscard]] std::optional<Reported<HallPoint>> position_of(const RobotRecord& robot);

/// The operating mode in the robot's own words: the first it sends of operating_mode, robot_mode, mode, state.
[[nodiscard]] std::optional<Reported<std::string>> mode_of(const RobotRecord& robot);

/// A value that the robot sends as a number, {"NAME": number} or plain words. Unknown: it sends none, or something
/// else.
[[nodiscard]] std::optional<Reported<double>> number_of(const RobotRecord& robot, std::string_view name);

/// Subtypes of the requests that bring charge and position up to date, as commands.json names them for every robot.
inline constexpr std::string_view kChargeRequests[] = {"state_of_charge", "battery"};
inline constexpr std::string_view kPositionRequest = "position";
/// The one of kChargeRequests whose answer charge_of() can read, as far as the robot's profile shows.
[[nodiscard]] std::string_view charge_request(const NodeProfile& profile);

}  // namespace trb::resilience
