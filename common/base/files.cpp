#include "common/base/files.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <string_view>

#include "common/base/descriptor.hpp"

namespace trb {
namespace {

constexpr std::chrono::seconds kPipeTime(1);
constexpr std::string_view kUnfinished = ".new";

Error io_fault(const std::string& path, const std::string& doing, int reason = errno) {
  const bool refused = reason == EACCES || reason == EPERM;
  return fail(Errc::io_error, path + ": cannot " + doing + ": " + std::strerror(reason),
              refused ? "run it as the user of the services, or who else may (namei -l " + path + ")" : "");
}

bool write_all(int fd, BytesView bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

using Deadline = std::chrono::steady_clock::time_point;

bool is_pipe(int fd) {
  struct stat facts {};
  return ::fstat(fd, &facts) == 0 && S_ISFIFO(facts.st_mode);
}

/// One without a name was made for this reader, as by <(command): the command may be asking a person.
bool has_name(int pipe) {
  struct statfs where {};
  return ::fstatfs(pipe, &where) != 0 || where.f_type != PIPEFS_MAGIC;
}

/// Of a pipe that is open at its other end: until something can be read, or that end is closed. False: nothing came
/// until then; whoever holds a pipe open that stands in a file's place may never write.
bool wait_for_bytes(int fd, Deadline until) {
  using std::chrono::milliseconds;
  const auto left = std::chrono::ceil<milliseconds>(until - std::chrono::steady_clock::now());
  const bool bounded = is_pipe(fd) && has_name(fd);
  pollfd one{fd, POLLIN, 0};
  const int ready = ::poll(&one, 1, bounded ? static_cast<int>(std::max(left, milliseconds(0)).count()) : -1);
  return ready > 0 || (ready < 0 && errno == EINTR);
}

Error no_file(const std::string& path, const std::string& but) {
  return fail(Errc::io_error, path + ": is a pipe, and " + but, "put a file there");
}

/// False: the new name may be lost after a power cut. A file system without support for this counts as synced.
bool sync_folder(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const Descriptor dir(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return !dir || ::fsync(dir.get()) == 0 || (errno != EIO && errno != ENOSPC);
}

/// Has write_file() begun it, and will never end it?
bool is_unfinished(const std::filesystem::path& path) {
  constexpr std::time_t kLongest = 600;
  const std::string digits = path.extension().string();  // ".new" and the writer's process id
  if (!digits.starts_with(kUnfinished) || digits.size() == kUnfinished.size() || !path.has_stem()) return false;
  if (digits.find_first_not_of("0123456789", kUnfinished.size()) != std::string::npos) return false;
  struct stat facts {};
  return ::lstat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_uid == ::geteuid() &&
         facts.st_mtime < std::time(nullptr) - kLongest;
}

void close_to_others(const std::filesystem::directory_entry& entry) {
  namespace fs = std::filesystem;
  std::error_code ignored;  // another user's, or gone meanwhile: only the folder itself is closed to others
  const fs::file_status is = entry.symlink_status(ignored);
  if (is.type() == fs::file_type::symlink || (is.permissions() & fs::perms(077)) == fs::perms::none) return;
  fs::permissions(entry.path(), fs::perms(077), fs::perm_options::remove | fs::perm_options::nofollow, ignored);
  if (ignored) fs::permissions(entry.path(), fs::perms(077), fs::perm_options::remove, ignored);
}

}  // namespace

Result<Bytes> read_file(const std::string& path, std::size_t max) {
  // Of a pipe that nobody writes to the opening alone would last for ever.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) {
    if (errno == ENOENT) return fail(Errc::missing, path + ": no such file");
    return io_fault(path, "open");
  }
  const Deadline until = std::chrono::steady_clock::now() + kPipeTime;
  Bytes out;
  char buffer[65536];
  for (;;) {
    const ssize_t count = ::read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) {
      if (wait_for_bytes(file.get(), until)) continue;
      return no_file(path, out.empty() ? "nothing comes out of it" : "its end does not come");
    }
    if (count < 0) return io_fault(path, "read");
    if (count == 0 && out.empty() && is_pipe(file.get())) return no_file(path, "nothing comes out of it");
    if (count == 0) return out;
    out.append(buffer, static_cast<std::size_t>(count));
    if (out.size() > max) return fail(Errc::too_large, path + ": over " + std::to_string(max) + " bytes");
  }
}

Status write_file(const std::string& path, BytesView bytes, unsigned mode) {
  const std::string beside = path + std::string(kUnfinished) + std::to_string(::getpid());
  {
    // Whatever has this name was left by a process that was killed, or put there by somebody: nothing is written into
    // it.
    ::unlink(beside.c_str());
    const Descriptor file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
    if (!file) return io_fault(beside, "create");
    // The umask must not widen or narrow what was asked for.
    if (::fchmod(file.get(), mode) != 0 || !write_all(file.get(), bytes) || ::fsync(file.get()) != 0) {
      const Error problem = io_fault(beside, "write");
      ::unlink(beside.c_str());
      return problem;
    }
  }
  if (std::rename(beside.c_str(), path.c_str()) != 0) {
    const Error problem = io_fault(path, "replace");
    ::unlink(beside.c_str());
    return problem;
  }
  if (!sync_folder(path)) return io_fault(path, "sync the folder of");
  return Done{};
}

void remove_unfinished_files(const std::string& folder) {
  std::error_code ignored;
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end; at.increment(ignored)) {
    if (is_unfinished(at->path())) ::unlink(at->path().c_str());
  }
}

Status overwrite_file(const std::string& path, BytesView bytes) {
  // Of a pipe that nobody reads the opening alone would last for ever.
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file && errno == ENOENT) return fail(Errc::missing, path + ": no such file");
  if (!file) return io_fault(path, "open");
  if (!write_all(file.get(), bytes) || ::fsync(file.get()) != 0) return io_fault(path, "write over");
  return Done{};
}

Status make_dir(const std::string& path, unsigned mode) {
  std::error_code problem;
  std::filesystem::create_directories(path, problem);
  if (problem) return io_fault(path, "make the folder", problem.value());
  if (::chmod(path.c_str(), mode) != 0) return io_fault(path, "set the mode of");
  return Done{};
}

Status make_private_dir(const std::string& path) {
  namespace fs = std::filesystem;
  ::umask(077);
  std::error_code problem;
  fs::create_directories(path, problem);
  std::error_code ignored;
  // Why it was not made, and not that it is not there.
  if (!fs::is_directory(path, ignored)) return io_fault(path, "make the folder", problem ? problem.value() : ENOTDIR);
  ::chmod(path.c_str(), 0700);
  for (fs::recursive_directory_iterator at(path, ignored), end; at != end; at.increment(ignored)) {
    if (ignored) break;
    close_to_others(*at);
  }
  return Done{};
}

Result<std::string> make_dir_beside(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  std::error_code ignored;
  if (!parent.empty() && !std::filesystem::exists(parent, ignored)) {
    if (Status made = make_private_dir(parent); !made) return made.error();
  }
  std::string out = path + std::string(kMakingBeside) + "XXXXXX";
  if (::mkdtemp(out.data()) == nullptr) return io_fault(path, "make the folder");
  return out;
}

Status look_for(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) == 0) return Done{};
  if (errno == ENOENT || errno == ENOTDIR) return fail(Errc::missing, path + ": no such file");
  return io_fault(path, "look for it");
}

bool file_exists(const std::string& path) {
  return look_for(path).ok();
}

}  // namespace trb
