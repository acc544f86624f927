// Files, read and written whole. For shells; a core has no files.
#pragma once

#include <string>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

/// The whole file. Errors: missing, too_large (over `max` bytes), io_error; each names the path.
Result<Bytes> read_file(const std::string& path, std::size_t max = 1U << 20U);

/// Writes a new file beside it, syncs it and renames it over the old one: after a crash either is there, whole.
Status write_file(const std::string& path, BytesView bytes, unsigned mode = 0644);

/// Makes the folder and its parents; an existing one is given the mode if it is this user's.
Status make_dir(const std::string& path, unsigned mode = 0755);

bool file_exists(const std::string& path);

}  // namespace trb
