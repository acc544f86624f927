#include "common/supervisor/node_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

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
    auto pid = read_file(lock_path(node_dir), 64);
    return fail(Errc::conflict, node_dir + " is up already (pid " + (pid ? std::to_string(pid_in(*pid)) : "?") + ")",
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
  Descriptor file(::open(lock_path(node_dir).c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) return none;
  const bool is_free = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
  file.reset();
  auto text = read_file(lock_path(node_dir), 64);
  if (is_free || !text) return none;
  const pid_t pid = pid_in(*text);
  // On a disk that cannot be written to, the pid is from an earlier start, and may belong to another process by now.
  const auto program = read_file("/proc/" + std::to_string(pid) + "/comm");
  if (pid > 0 && program && *program == "trb\n") return pid;
  return fail(Errc::io_error,
              node_dir + " is up, but " + lock_path(node_dir) + " does not hold its pid: its disk is full",
              "make room there (df -h " + node_dir + ") and start it again: trb up " + node_dir);
}

}  // namespace trb::supervisor
