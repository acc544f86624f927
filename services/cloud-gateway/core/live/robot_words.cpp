#include "services/cloud-gateway/core/live/robot_words.hpp"

#include <algorithm>
#include <tuple>

namespace trb::gateway {
namespace {

/// A repeated value keeps its time.
void set_value(RobotRow& row, const RobotValueTold& told, UtcTime now) {
  const auto at = std::lower_bound(row.values.begin(), row.values.end(), told.name,
                                   [](const RobotValue& one, const std::string& name) { return one.name < name; });
  if (at != row.values.end() && at->name == told.name) {
    if (at->value != told.value) *at = {told.name, told.value, now};
  } else if (row.values.size() < kMaxValues) {
    row.values.insert(at, {told.name, told.value, now});
  } else {
    row.cut = true;
  }
}

/// As in the node's profile: one end message ends all faults of a capability.
bool is_same(const RobotRowFault& one, const RobotFault& told) {
  return one.capability == told.capability && (told.ended || one.severity == told.severity);
}

bool is_standing(const OutOfUse& one) {
  return !one.retired && one.severity >= Severity::critical;
}

const OutOfUse* standing_in(const std::vector<OutOfUse>& list, std::string_view capability) {
  const auto at =
      std::ranges::find_if(list, [&](const OutOfUse& one) { return is_standing(one) && one.capability == capability; });
  return at == list.end() ? nullptr : &*at;
}

/// What the node's profile had and has no more is over, with that fault of each capability if it was of the whole
/// robot: the robot's own word of the end may be lost.
void end_unlisted(RobotRow& row, const std::vector<OutOfUse>& listed) {
  for (const OutOfUse& old : row.out_of_use) {
    if (!is_standing(old) || standing_in(listed, old.capability) != nullptr) continue;
    std::erase_if(row.faults, [&](const RobotRowFault& one) {
      const bool with_it = old.capability.empty() && standing_in(listed, one.capability) == nullptr;
      return one.severity >= Severity::critical && (one.capability == old.capability || with_it);
    });
  }
}

}  // namespace

void apply(RobotRow& row, const RobotState& state, UtcTime now) {
  for (const RobotValueTold& told : state.values) set_value(row, told, now);
}

void apply(RobotRow& row, const RobotConnection& connection, UtcTime) {
  row.connection = connection.state;
  row.detail = connection.detail;
}

void apply(RobotRow& row, const RobotFault& fault, UtcTime now) {
  const auto same = [&](const RobotRowFault& one) { return is_same(one, fault); };
  const auto at = std::find_if(row.faults.begin(), row.faults.end(), same);
  if (fault.ended) {
    row.faults.erase(std::remove_if(row.faults.begin(), row.faults.end(), same), row.faults.end());
  } else if (at != row.faults.end()) {
    at->text = fault.text;
  } else if (row.faults.size() < kMaxFaults) {
    row.faults.push_back({fault.capability, fault.severity, fault.text, now});
    std::sort(row.faults.begin(), row.faults.end(), [](const RobotRowFault& a, const RobotRowFault& b) {
      return std::tie(a.capability, a.severity) < std::tie(b.capability, b.severity);
    });
  } else {
    row.cut = true;
  }
}

bool forget_lesser(RobotRow& row, UtcTime now) {
  const auto is_old = [&](const RobotRowFault& one) {
    return one.severity < Severity::critical && one.since < now - kLesserShown;
  };
  return std::erase_if(row.faults, is_old) > 0;
}

void apply(RobotRow& row, const NodeProfile& profile, UtcTime) {
  row.connection = profile.robot;
  row.detail = profile.detail;
  row.fenced = profile.fenced;
  row.control = profile.control;
  row.drives = profile.drives;
  // A node that has just begun has not told of its robot yet: that ends nothing.
  if (profile.robot.empty() && profile.out_of_use.empty()) return;
  end_unlisted(row, profile.out_of_use);
  row.out_of_use = profile.out_of_use;
}

}  // namespace trb::gateway
