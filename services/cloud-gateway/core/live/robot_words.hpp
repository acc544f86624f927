// Applies the messages of a robot and of its node to the robot's row.
#pragma once

#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

inline constexpr std::size_t kMaxValues = 64;
inline constexpr std::size_t kMaxFaults = 64;

void apply(RobotRow& row, const RobotState& state, UtcTime now);
void apply(RobotRow& row, const RobotConnection& connection, UtcTime now);
/// Removes a fault that has ended; ignores the end of an unknown one.
void apply(RobotRow& row, const RobotFault& fault, UtcTime now);
/// Ends the faults that it lists no more.
void apply(RobotRow& row, const NodeProfile& profile, UtcTime now);

/// The end of a WARNING or URGENT fault is told by nobody: it is shown for this long, as in the list of alerts.
inline constexpr Duration kLesserShown = std::chrono::minutes(15);
/// Removes lesser faults that are older. False: there was none.
bool forget_lesser(RobotRow& row, UtcTime now);

}  // namespace trb::gateway
