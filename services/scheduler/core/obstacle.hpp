// Why a robot begins no task now, in words for a person, with what cures it.
#pragma once

#include <string>

#include "proto/bodies/link.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::scheduler {

/// By its mode-adapter. Empty: it can begin what needs that skill.
std::string obstacle_of(const AdapterState& state, const std::string& skill);
/// By what its node tells of itself, which is less: whether it is busy is not in a profile. A node that has told
/// nothing of its robot yet has no obstacle, nor has one whose robot a run commands.
std::string obstacle_of(const NodeProfile& profile, const std::string& skill);

}  // namespace trb::scheduler
