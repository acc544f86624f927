// Whether an audit is what was written: for anybody, with its rows, signed heads and the fleet's public key alone.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "services/cloud-gateway/core/access/audit_chain.hpp"

namespace trb::gateway {

enum class AuditFaultKind : std::uint8_t {
  other_chain,   ///< a head of another node or fleet
  missing,       ///< the record with this number is not there; what comes next is later
  out_of_order,  ///< a record where another number must stand: moved, repeated or put in
  altered,       ///< the record is not what was hashed, or its text is no record's
  other_head,    ///< rows that fit each other, and not the head that was signed: hashed anew from somewhere on
  truncated,     ///< a signed head tells of a record behind the last
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
  std::uint64_t good = 0;     ///< records from the first on that fit
  std::uint64_t covered = 0;  ///< of these, proven by a signed head; later ones whoever has the store may still change
  std::optional<AuditFault> fault;
};

/// `rows`: from number 1 on, as they are stored. `heads`: whose signatures the caller has checked, in any order.
AuditReport verify_audit(BytesView start, std::span<const AuditRow> rows, std::span<const AuditHead> heads);

}  // namespace trb::gateway
