// Brings a SQLite file's tables to this build's version (PRAGMA user_version).
#pragma once

#include <span>
#include <string_view>

#include "common/sqlite/sqlite_file.hpp"

namespace trb {

/// The script from version n to n+1 is steps[n]; none is changed once it is released. All that are missing run in one
/// transaction; an empty file has version 0. `cure`: what to do about a file of a newer build. Errors: version_mismatch
/// (that one), and those of SqliteFile.
Status migrate(SqliteFile& file, std::span<const char* const> steps, std::string_view hint);

}  // namespace trb
