#include "services/cloud-gateway/core/access/audit_heads.hpp"

#include <algorithm>

namespace trb::gateway {

std::optional<AuditHead> AuditHeads::due(const AuditChain& chain, Now now) {
  const auto at = next_deadline(chain);
  if (!at || now.mono < *at) return std::nullopt;
  asked_ = chain.number();
  asked_at_ = now.mono;
  return chain.head(now.utc);
}

void AuditHeads::signed_to(std::uint64_t number) {
  covered_ = std::max(covered_, number);
  if (asked_ && *asked_ <= covered_) asked_.reset();
}

std::optional<MonotonicTime> AuditHeads::next_deadline(const AuditChain& chain) const {
  if (chain.number() <= covered_) return std::nullopt;
  if (!asked_at_) return MonotonicTime{};
  return *asked_at_ + (asked_ ? kHeadAnswer : kHeadEvery);
}

}  // namespace trb::gateway
