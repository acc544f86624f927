// Converts what the gateway keeps to rows, and back: users, sessions, tokens, requests, scenarios, the steady time.
#pragma once

#include "services/cloud-gateway/io/store/gateway_db.hpp"
#include "services/cloud-gateway/io/store/sql.hpp"

namespace trb::gateway {

/// Writes all of the batch but audit records and heads. Call it within a transaction. Errors: conflict (no enabled
/// admin would be left), and those of Sql.
Status write_state(Sql& sql, const StoreBatch& batch);

/// The rows of these kinds, without audit records and heads; and the steady time. Errors: those of Sql; malformed (a
/// row that no build has written).
Status read_state(Sql& sql, const StoreKinds& kinds, StoredState& out);

}  // namespace trb::gateway
