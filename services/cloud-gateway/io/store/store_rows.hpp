// Converts what the gateway keeps to rows, and back: users, sessions, tokens, requests, scenarios, the steady time.
#pragma once

#include "common/sqlite/sqlite_file.hpp"
#include "services/cloud-gateway/io/store/gateway_db.hpp"

namespace trb::gateway {

/// Writes all of the batch but audit records and heads. Call it within a transaction. Errors: conflict (no enabled
/// admin would be left), and those of SqliteFile.
Status write_state(SqliteFile& file, const StoreBatch& batch);

/// All but audit records and heads. Errors: those of SqliteFile; malformed (a row that no build has written).
Status read_state(SqliteFile& file, StoredState& out);

}  // namespace trb::gateway
