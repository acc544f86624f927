// When the head of the audit log is signed.
#pragma once

#include <optional>

#include "common/audit/audit_chain.hpp"

namespace trb::gateway {

constexpr Duration kHeadEvery = std::chrono::minutes(1);
constexpr Duration kHeadAnswer = std::chrono::seconds(10);

/// idle  | a minute since the last request, and a new record       | asked: sign the head
/// asked | signed                                                  | idle
/// asked | 10 s: refused, or no answer                             | asked again, with the newest head
/// idle  | signed, late or repeated                                | idle: a signature of an older head stays valid
/// After a start the first head is due at once; call signed_to() for what was covered before.
class AuditHeads {
 public:
  /// The head to sign, if one is due.
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
