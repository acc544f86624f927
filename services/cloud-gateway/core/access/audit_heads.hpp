// When the audit's head is signed.
#pragma once

#include <optional>

#include "services/cloud-gateway/core/access/audit_chain.hpp"

namespace trb::gateway {

constexpr Duration kHeadEvery = std::chrono::minutes(1);
constexpr Duration kHeadAnswer = std::chrono::seconds(10);

/// idle  | a minute since the last was asked for, and a new record | asked: the head is to be signed
/// asked | signed                                                  | idle
/// asked | 10 s: refused, or no answer                             | asked anew, with the head as it is then
/// idle  | signed, late or again                                   | idle: a signature of an older head is still good
/// After a start the first head is due at once; signed_to() tells what was covered before.
class AuditHeads {
 public:
  /// The head to be signed, if it is time.
  std::optional<AuditHead> due(const AuditChain& chain, Now now);
  /// A signature over the head with this number is stored.
  void signed_to(std::uint64_t number);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline(const AuditChain& chain) const;
  /// The last record that a signed head covers.
  [[nodiscard]] std::uint64_t covered() const { return covered_; }

 private:
  std::uint64_t covered_ = 0;
  std::optional<std::uint64_t> asked_;
  std::optional<MonotonicTime> asked_at_;  ///< the last one
};

}  // namespace trb::gateway
