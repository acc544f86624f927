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
void apply(RobotRow& row, const NodeProfile& profile, UtcTime now);

}  // namespace trb::gateway
