#include "services/resilience/core/inquiry.hpp"

namespace trb::resilience {

void Inquiry::on_ranked(Now now) {
  ranked_at_ = now.mono;
  value_at_.reset();
}

bool Inquiry::begin(Now now) {
  if (asked_at_ && now.mono - *asked_at_ < kAgain) return false;
  asked_at_ = now.mono;
  awaited_.clear();
  return true;
}

bool Inquiry::on_answer(const std::string& robot, const std::string& value) {
  return awaited_.erase({robot, value}) != 0 && awaited_.empty();
}

std::string Inquiry::awaited_robot(Duration patience, Now now) const {
  const bool waits = asked_at_ && now.mono - *asked_at_ < patience && !awaited_.empty();
  return waits ? awaited_.begin()->first : std::string();
}

void Inquiry::on_value(Now now) {
  if (!value_at_) value_at_ = now.mono;
}

std::optional<MonotonicTime> Inquiry::follow_at() const {
  return value_at_ ? std::optional(*value_at_ + kCrowd) : std::nullopt;
}

}  // namespace trb::resilience
