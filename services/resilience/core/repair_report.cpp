#include "services/resilience/core/repair_report.hpp"

namespace trb::resilience {

bool RepairReport::is_due(Now now) const {
  const bool answered = refused_at_ || (taken_at_ && now.mono - *taken_at_ < kSendAgain);
  return !answered && send_.is_due(now.mono);
}

void RepairReport::on_sent(Now now) {
  send_.on_sent(now.mono);
  taken_at_.reset();
}

void RepairReport::on_taken(Now now) {
  if (send_.next()) taken_at_ = now.mono;
}

void RepairReport::on_refused(const std::string& why, Now now) {
  if (!send_.next() || done_ || taken_at_ || refused_at_) return;
  refused_at_ = now.mono;
  refusal_ = why;
}

std::optional<std::string> RepairReport::refusal(Now now) const {
  return refused_at_ && now.mono - *refused_at_ >= kProfile ? std::optional(refusal_) : std::nullopt;
}

}  // namespace trb::resilience
