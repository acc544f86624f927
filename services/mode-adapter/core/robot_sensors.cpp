#include "services/mode-adapter/core/robot_sensors.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

constexpr Duration kPause = std::chrono::seconds(1);
constexpr std::size_t kMaxValue = 1024;

}  // namespace

RobotSensors::RobotSensors(const std::vector<std::string>& names) {
  for (const std::string& name : names) values_.push_back({name, {}});
}

void RobotSensors::on_value(std::string_view name, const RobotValue& value) {
  const auto found = std::ranges::find(values_, name, &RobotValueTold::name);
  if (found == values_.end() || found->value == value.json || value.json.size() > kMaxValue) return;
  const bool is_list = value.json.starts_with('[');
  changed_ = changed_ || !is_list || found->value.empty();
  found->value = value.json;
}

void RobotSensors::tick(Now now, Outbox& out) {
  if (!changed_ || now.mono < not_before_) return;
  changed_ = false;
  not_before_ = now.mono + kPause;
  RobotState state;
  std::copy_if(values_.begin(), values_.end(), std::back_inserter(state.values),
               [](const RobotValueTold& told) { return !told.value.empty(); });
  out.information(std::string(kEveryNode), std::move(state));
}

std::optional<MonotonicTime> RobotSensors::next_deadline() const {
  return changed_ ? std::optional(not_before_) : std::nullopt;
}

}  // namespace trb::adapter
