#include "services/cli/io/folder_owner.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string_view>

namespace trb::cli {
namespace {

constexpr int kDeepest = 4;  ///< keys/bus is one below keys

void give(int in, const char* name, const struct stat& owner, int deep);

/// All that lies in the folder `at`.
void give_entries(int at, const struct stat& owner, int deep) {
  const int folder = ::openat(at, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  DIR* const entries = ::fdopendir(folder);
  if (entries == nullptr) return static_cast<void>(::close(folder));
  while (const dirent* entry = ::readdir(entries)) {
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") give(folder, entry->d_name, owner, deep + 1);
  }
  ::closedir(entries);
}

/// What lies at `name` in the open folder `in`, and all below it. Each step is taken from an open descriptor and
/// follows no link: the folder's owner may change it meanwhile, and must not lead root elsewhere.
void give(int in, const char* name, const struct stat& owner, int deep) {
  const int at = ::openat(in, name, O_PATH | O_NOFOLLOW | O_CLOEXEC);
  if (at < 0) return;
  struct stat now {};
  const bool known = ::fstat(at, &now) == 0;
  const bool is_folder = known && S_ISDIR(now.st_mode);
  const bool is_file = known && S_ISREG(now.st_mode) && now.st_nlink == 1;
  // Who cannot be given a file says so when the service reads it.
  if ((is_folder || is_file) && now.st_uid == 0)
    static_cast<void>(::fchownat(at, "", owner.st_uid, owner.st_gid, AT_EMPTY_PATH) == 0);
  if (is_folder && deep < kDeepest) give_entries(at, owner, deep);
  ::close(at);
}

}  // namespace

void give_keys_to_owner(const std::string& dir) {
  if (::geteuid() != 0) return;
  const int folder = ::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  struct stat owner {};
  if (folder >= 0 && ::fstat(folder, &owner) == 0 && owner.st_uid != 0) give(folder, "keys", owner, 0);
  if (folder >= 0) ::close(folder);
}

}  // namespace trb::cli
