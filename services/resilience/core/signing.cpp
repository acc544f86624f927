#include "services/resilience/core/signing.hpp"

#include <utility>

namespace trb::resilience {

void Signing::begin(Now now) {
  if (!since_) since_ = now.mono;
}

void Signing::prepare(Bytes payload, std::uint32_t epoch) {
  payload_ = std::move(payload);
  epoch_ = epoch;
}

bool Signing::on_signed(const SignedRecord& record) {
  if (payload_.empty() || payload_ != record.payload.bytes) return false;
  record_ = record;
  payload_.clear();
  return true;
}

void Signing::restore(SignedRecord record, std::uint32_t epoch) {
  record_ = std::move(record);
  epoch_ = epoch;
}

std::optional<MonotonicTime> Signing::next(Now now) const {
  std::optional<MonotonicTime> out;
  for (const ResendTimer* timer : {&release_, &sign_, &hand_}) {
    if (const auto at = timer->next(); at && *at > now.mono) out = earlier(out, at);
  }
  return out;
}

bool Signing::take(ResendTimer& timer, Now now) {
  if (!timer.is_due(now.mono)) return false;
  timer.on_sent(now.mono);
  return true;
}

}  // namespace trb::resilience
