#include "common/simulation/planned_sensor.hpp"

#include <algorithm>

namespace trb::simulation {

Measured Course::at(double seconds) const {
  if (steps_.empty()) return {};
  const auto next = std::ranges::upper_bound(steps_, seconds, {}, &Step::at_s);
  if (next == steps_.begin()) return steps_.front().value;
  const Step& last = *(next - 1);
  if (!is_ramp_ || next == steps_.end()) return last.value;
  const double part = (seconds - last.at_s) / (next->at_s - last.at_s);
  return std::get<double>(last.value) + part * (std::get<double>(next->value) - std::get<double>(last.value));
}

bool Course::tells(bool text) const {
  const auto is_wanted = [&](const Step& step) {
    return text ? std::holds_alternative<std::string>(step.value) : std::holds_alternative<double>(step.value);
  };
  const auto is_unread = [](const Step& step) { return std::holds_alternative<std::monostate>(step.value); };
  return std::ranges::any_of(steps_, is_wanted) || std::ranges::all_of(steps_, is_unread);
}

std::optional<Course::Late> Course::after(double seconds) const {
  const auto next = std::ranges::upper_bound(steps_, seconds, {}, &Step::at_s);
  if (next == steps_.end()) return std::nullopt;
  return Late{next->at_s, static_cast<std::size_t>(steps_.end() - next)};
}

}  // namespace trb::simulation
