#include "services/mode-adapter/core/outcomes.hpp"

#include <algorithm>

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxKept = 256;

}  // namespace

const Outcome* Outcomes::find(const AttemptKey& key) const {
  const auto found = kept_.find(key);
  return found == kept_.end() ? nullptr : &found->second.outcome;
}

bool Outcomes::make_room() {
  if (kept_.size() < kMaxKept) return true;
  auto oldest = kept_.end();
  for (auto at = kept_.begin(); at != kept_.end(); ++at) {
    if (!at->second.acknowledged) continue;
    if (oldest == kept_.end() || at->second.order < oldest->second.order) oldest = at;
  }
  if (oldest == kept_.end()) return false;
  kept_.erase(oldest);
  return true;
}

void Outcomes::add(Outcome outcome, Now now) {
  const AttemptKey key = outcome.key;
  if (!kept_.emplace(key, Kept{std::move(outcome), ++order_, now.mono, false}).second) return;
  ++waiting_;
  if (!resend_at_) resend_at_ = now.mono + kResend;
}

void Outcomes::acknowledge(const AttemptKey& key) {
  const auto found = kept_.find(key);
  if (found == kept_.end() || found->second.acknowledged) return;
  found->second.acknowledged = true;
  if (--waiting_ == 0) resend_at_.reset();
}

bool Outcomes::wait(Now now) const {
  return waiting_ != 0 && std::ranges::any_of(kept_, [&](const auto& one) {
           return !one.second.acknowledged && now.mono < one.second.since + kPatience;
         });
}

}  // namespace trb::adapter
