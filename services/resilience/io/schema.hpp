// The tables of capability.db and their versions (PRAGMA user_version).
#pragma once

#include "common/sqlite/sqlite_file.hpp"

namespace trb::resilience {

constexpr int kSchemaVersion = 3;

/// Brings the file to kSchemaVersion, step by step, in one transaction; an empty file too. Errors: version_mismatch (a
/// newer build wrote it), malformed, io_error.
Status migrate(SqliteFile& file);

}  // namespace trb::resilience
