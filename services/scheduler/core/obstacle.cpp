#include "services/scheduler/core/obstacle.hpp"

#include <algorithm>
#include <vector>

namespace trb::scheduler {
namespace {

/// nullptr: the robot has no such skill.
template <class Skill>
const std::string* capability_for(const std::vector<Skill>& skills, const std::string& skill) {
  const auto at = std::ranges::find(skills, skill, &Skill::name);
  return at == skills.end() ? nullptr : &at->capability;
}

std::string connection_text(const std::string& robot, const std::string& detail) {
  return "the robot is " + (robot.empty() ? "not there" : robot) + (detail.empty() ? "" : ": " + detail);
}

std::string control_text(const std::string& holder) {
  return "the robot is controlled by '" + holder + "', until 10 s after its last command";
}

constexpr const char* kStopped = "the robot is stopped until 'trb release'";

/// `capability`: what the task needs; nullptr: not known.
std::string out_of_use_text(const std::vector<OutOfUse>& out_of_use, const std::string* capability) {
  for (const OutOfUse& one : out_of_use) {
    const std::string by = one.by.empty() ? "" : " (" + one.by + ")";
    if (one.retired) return "the robot is out of service: " + one.text + by + "; trb robot return takes it back";
    const bool all = one.capability.empty();
    if (!all && (capability == nullptr || *capability != one.capability)) continue;
    return (all ? "the robot" : "its '" + one.capability + "'") +
           " is out of use: " + std::string(name_of(one.severity)) + ": " + one.text + by +
           "; once it is mended, and if the robot itself does not say so: trb robot repaired";
  }
  return {};
}

}  // namespace

std::string obstacle_of(const AdapterState& state, const std::string& skill) {
  if (state.robot != "ONLINE") return connection_text(state.robot, "");
  if (state.fenced) return kStopped;
  if (!state.control.empty()) return control_text(state.control);
  if (state.busy) return "the robot is busy";
  return out_of_use_text(state.out_of_use, capability_for(state.skills, skill));
}

std::string obstacle_of(const NodeProfile& profile, const std::string& skill) {
  if (profile.robot.empty()) return {};
  if (profile.robot != "ONLINE") return connection_text(profile.robot, profile.detail);
  if (profile.fenced) return kStopped;
  if (!profile.control.empty() && !profile.control.starts_with("run ")) return control_text(profile.control);
  return out_of_use_text(profile.out_of_use, capability_for(profile.skills, skill));
}

}  // namespace trb::scheduler
