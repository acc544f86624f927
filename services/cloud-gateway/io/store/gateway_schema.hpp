// The tables of gateway.db and their versions.
#pragma once

#include "common/sqlite/sqlite_file.hpp"

namespace trb::gateway {

/// Brings the file to this build's version. Errors: version_mismatch (a newer build wrote it), and those of SqliteFile.
Status migrate_gateway(SqliteFile& file);

}  // namespace trb::gateway
