// What a robot, or its node, says of it goes into its row.
#pragma once

#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

inline constexpr std::size_t kMaxValues = 64;
inline constexpr std::size_t kMaxFaults = 64;

void apply(RobotRow& row, const RobotState& state, UtcTime now);
void apply(RobotRow& row, const RobotConnection& connection, UtcTime now);
/// A fault that has ended is taken away, and one that ends before it was heard is none.
void apply(RobotRow& row, const RobotFault& fault, UtcTime now);
void apply(RobotRow& row, const NodeProfile& profile, UtcTime now);

}  // namespace trb::gateway
