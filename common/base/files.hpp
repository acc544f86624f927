// Files, read and written whole. For shells; a core has no files.
#pragma once

#include <string>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

/// The whole file. Errors: missing, too_large (over `max` bytes), io_error; each names the path.
Result<Bytes> read_file(const std::string& path, std::size_t max = 1U << 20U);

/// Writes a new file beside it, syncs it and renames it over the old one: after a crash either is there, whole.
/// Errors: io_error; then the old one is there, whole, and nothing of the new one.
Status write_file(const std::string& path, BytesView bytes, unsigned mode = 0600);

/// Writes over the start of a file that is there, and syncs it: a full disk has room for that if the file is as long
/// already. After a power cut it may hold a part of either. Errors: missing, io_error.
Status overwrite_file(const std::string& path, BytesView bytes);

/// Makes the folder and its parents; an existing one is given the mode if it is this user's.
Status make_dir(const std::string& path, unsigned mode = 0755);

/// A folder for this user alone: it gets the mode 0700, what is in it loses every right of others, and what this
/// process makes from now on has none (umask 077). Errors: io_error if there is none and it cannot be made.
Status make_private_dir(const std::string& path);

bool file_exists(const std::string& path);

}  // namespace trb
