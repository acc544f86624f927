// Converts audit records and signed heads to rows, and back.
#pragma once

#include "services/cloud-gateway/io/store/gateway_db.hpp"
#include "services/cloud-gateway/io/store/sql.hpp"

namespace trb::gateway {

/// Appends the batch's audit records and heads. Call it within a transaction. Errors: conflict (a record does not
/// follow the last one), and those of Sql.
Status write_audit(Sql& sql, const StoreBatch& batch);

/// The newest first. Errors: bad_value (`most`), and those of Sql.
Result<std::vector<AuditRow>> read_audit(Sql& sql, const AuditQuery& query);
/// `most` rows from that number on, in order.
Result<std::vector<AuditRow>> read_audit_from(Sql& sql, std::uint64_t number, std::size_t most);
/// By number.
Result<std::vector<SignedHead>> read_heads(Sql& sql, std::uint64_t first, std::uint64_t last);

/// The last record, and the highest number of a signed head.
Status read_end(Sql& sql, StoredState& out);

}  // namespace trb::gateway
