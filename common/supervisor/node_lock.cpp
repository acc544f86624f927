#include "common/supervisor/node_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>

#include "common/base/files.hpp"
#include "common/base/number_text.hpp"

namespace trb::supervisor {
namespace {

std::string lock_path(const std::string& node_dir) {
  return node_dir + "/state/up.lock";
}

constexpr std::size_t kPidDigits = 10;

pid_t pid_in(const std::string& text) {
  return parse_number<pid_t>(text.substr(0, text.find('\n'))).value_or(0);
}

/// Who holds the lock by the kernel's own list, which knows it also if no byte could be written; 0: it does not say.
/// Of a process in another container it does not.
pid_t pid_of_kernel(int file) {
  struct stat facts {};
  if (::fstat(file, &facts) != 0) return 0;
  char at[64];
  std::snprintf(at, sizeof at, " %02x:%02x:%ju ", major(facts.st_dev), minor(facts.st_dev),
                static_cast<std::uintmax_t>(facts.st_ino));
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    // "3: FLOCK  ADVISORY  WRITE 4711 00:2f:815 0 EOF"; who waits for a lock has "->" before its kind.
    const std::size_t place = line.find(at);
    if (place == std::string::npos || line.find(": FLOCK ") == std::string::npos) continue;
    const std::size_t pid = line.rfind(' ', place - 1);
    return parse_number<pid_t>(line.substr(pid + 1, place - pid - 1)).value_or(0);
  }
  return 0;
}

/// On a disk that cannot be written to, an existing lock file can still be locked.
Descriptor open_lock(const std::string& node_dir) {
  Descriptor file(::open(lock_path(node_dir).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (file || errno != EROFS) return file;
  return Descriptor(::open(lock_path(node_dir).c_str(), O_RDONLY | O_CLOEXEC));
}

}  // namespace

Result<NodeLock> NodeLock::take(const std::string& node_dir) {
  if (Status made = make_private_dir(node_dir + "/state"); !made) return made.error();
  Descriptor file = open_lock(node_dir);
  if (!file) return fail(Errc::io_error, lock_path(node_dir) + ": cannot open");
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    const auto pid = holder(node_dir);
    return fail(Errc::conflict, node_dir + " is up already (pid " + (pid ? std::to_string(*pid) : "?") + ")",
                "stop that one first, or use trb reload " + node_dir);
  }
  // The same length each time: on a full disk the new text fits into the place of the old one. The lock itself takes no
  // byte.
  std::string text = std::to_string(::getpid());
  text = std::string(kPidDigits - std::min(text.size(), kPidDigits), '0') + text + "\n";
  const bool written = ::pwrite(file.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written) (void)!::ftruncate(file.get(), 0);
  return NodeLock(std::move(file));
}

Result<pid_t> NodeLock::holder(const std::string& node_dir) {
  const Error none = fail(Errc::missing, node_dir + " is not up", "start it: trb up " + node_dir);
  const auto text = read_file(lock_path(node_dir), 64);
  if (!text) return text.error().code == Errc::missing ? none : text.error();
  {
    const Descriptor file(::open(lock_path(node_dir).c_str(), O_RDONLY | O_CLOEXEC));
    if (!file || ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) return none;
    if (const pid_t known = pid_of_kernel(file.get()); known > 0) return known;
  }
  const pid_t pid = pid_in(*text);
  // On a disk that cannot be written to, the pid is from an earlier start, and may belong to another process by now.
  const auto program = read_file("/proc/" + std::to_string(pid) + "/comm");
  if (pid > 0 && program && *program == "trb\n") return pid;
  return fail(Errc::io_error, node_dir + " is up, but " + lock_path(node_dir) + " does not hold its pid",
              "end it where it was started: perhaps in another container");
}

}  // namespace trb::supervisor
