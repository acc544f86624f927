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
  row.out_of_use = profile.out_of_use;
  row.drives = profile.drives;
}

}  // namespace trb::gateway
