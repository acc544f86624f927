#include "services/cli/io/folder_owner.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace trb::cli {
namespace {

namespace fs = std::filesystem;

void give(const std::string& path, const struct stat& owner) {
  struct stat now {};
  if (::lstat(path.c_str(), &now) != 0 || now.st_uid == owner.st_uid) return;
  const bool is_its_own = S_ISDIR(now.st_mode) || (S_ISREG(now.st_mode) && now.st_nlink == 1);
  // Who cannot be given a file says so when the service reads it.
  if (is_its_own) static_cast<void>(::lchown(path.c_str(), owner.st_uid, owner.st_gid) == 0);
}

}  // namespace

void give_keys_to_owner(const std::string& dir) {
  struct stat owner {};
  if (::geteuid() != 0 || ::stat(dir.c_str(), &owner) != 0) return;
  const std::string keys = dir + "/keys";
  give(keys, owner);
  std::error_code problem;
  for (fs::recursive_directory_iterator at(keys, problem), end; !problem && at != end; at.increment(problem))
    give(at->path().string(), owner);
}

}  // namespace trb::cli
