// Checks that nobody changed an audit log. It needs only the rows, the signed heads and the fleet's public key.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/audit/audit_chain.hpp"

namespace trb {

enum class AuditFaultKind : std::uint8_t {
  other_chain,   ///< a head of another node or fleet
  missing,       ///< no record with this number; the next one has a higher number
  out_of_order,  ///< a record with a wrong number: moved, repeated or inserted
  altered,       ///< the record does not match its hash, or is not canonical
  other_head,    ///< rows match each other but not the signed head: somebody computed the hashes again
  truncated,     ///< a signed head covers a record after the last one
};
constexpr auto enum_names(AuditFaultKind) {
  return std::array<std::string_view, 6>{"other_chain", "missing",    "out_of_order",
                                         "altered",     "other_head", "truncated"};
}

struct AuditFault {
  AuditFaultKind kind{};
  std::uint64_t number = 0;  ///< the first record that does not fit
  std::string what;
};

struct AuditReport {
  std::uint64_t good = 0;     ///< the last record that fits, and so do all before it
  std::uint64_t covered = 0;  ///< of these, proven by a signed head; whoever has the store can still change later ones
  /// Records that tell of a store that came from a backup: what was recorded between the one before and this one is
  /// lost.
  std::vector<AuditRecord> restored;
  std::optional<AuditFault> fault;
};

/// `rows`: from number 1 on, as stored. `heads`: in any order; the caller has checked their signatures.
AuditReport verify_audit(BytesView start, std::span<const AuditRow> rows, std::span<const AuditHead> heads);

}  // namespace trb
