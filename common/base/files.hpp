// Files, read and written whole. For shells; a core has no files.
#pragma once

#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

/// The whole file. A pipe that stands in its place has a second to give all. Errors: missing, too_large (over `max`
/// bytes), io_error; each names the path.
Result<Bytes> read_file(const std::string& path, std::size_t max = 1U << 20U);

/// Writes a new file beside it, syncs it and renames it over the old one: after a crash one of the two is there,
/// complete. Errors: io_error; nothing of the new file is left beside it then, and the old one is unchanged, unless the
/// text says "cannot sync the folder of": then it is replaced, and a power cut may bring the old one back.
Status write_file(const std::string& path, BytesView bytes, unsigned mode = 0600);

/// Removes what writers that were killed have left in the folder: this user's files NAME.new and digits, which nobody
/// has written to for ten minutes. They may hold private keys.
void remove_unfinished_files(const std::string& folder);

/// Overwrites the start of an existing file and syncs it: works on a full disk if the file is already long enough.
/// After a power cut it may hold parts of both. Errors: missing, io_error.
Status overwrite_file(const std::string& path, BytesView bytes);

/// Makes the folder and its parents; an existing folder gets the mode if this user owns it.
Status make_dir(const std::string& path, unsigned mode = 0755);

/// A folder for this user only: it gets the mode 0700, others lose all rights to its content, and the process's umask
/// becomes 077. Errors: io_error if it does not exist and cannot be made.
Status make_private_dir(const std::string& path);

/// Makes a private folder beside that path, and the folders that lead to it. Its name is one that nobody has
/// (PATH.making- and six letters): a folder of another's is not touched, and two who make the same thing do not mix
/// their files. Errors: io_error.
Result<std::string> make_dir_beside(const std::string& path);
constexpr std::string_view kMakingBeside = ".making-";

/// Whether something is there under this name. Errors: missing; io_error if that cannot be known, as in a folder that
/// this user may not look into.
Status look_for(const std::string& path);

/// False also if it cannot be known; who says "missing" to a person asks look_for.
bool file_exists(const std::string& path);

}  // namespace trb
