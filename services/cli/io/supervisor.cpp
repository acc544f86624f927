#include "services/cli/io/supervisor.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "common/base/files.hpp"
#include "common/transport/loop.hpp"

namespace trb::cli {
namespace {

constexpr Duration kFirstWait = std::chrono::milliseconds(100);
constexpr Duration kMostWait = std::chrono::seconds(2);
constexpr Duration kSettled =
    std::chrono::seconds(10);  ///< up for so long: the next fall starts with a short wait again
constexpr Duration kGrace = std::chrono::seconds(3);
constexpr Duration kReadyCheck = std::chrono::milliseconds(100);
constexpr int kAgain = 75;

std::string lock_path(const std::string& node_dir) {
  return node_dir + "/state/up.lock";
}

constexpr std::size_t kPidDigits = 10;

pid_t pid_in(const std::string& text) {
  return static_cast<pid_t>(std::strtol(text.c_str(), nullptr, 10));
}

/// On a disk that cannot be written to, a lock file that is there can be locked as well.
int open_lock(const std::string& node_dir) {
  const int fd = ::open(lock_path(node_dir).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd >= 0 || errno != EROFS) return fd;
  return ::open(lock_path(node_dir).c_str(), O_RDONLY | O_CLOEXEC);
}

/// Waits for one of the blocked signals; 0 if none came in time.
int wait_signal(Duration wait) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGCHLD}) sigaddset(&set, signal);
  const auto ns = std::max<Duration>(wait, Duration::zero()).count();
  const timespec time{ns / 1'000'000'000, ns % 1'000'000'000};
  const int signal = ::sigtimedwait(&set, nullptr, &time);
  return signal > 0 ? signal : 0;
}

[[noreturn]] void become(const std::string& program, const std::string& node_dir) {
  die_with_parent();
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execl(program.c_str(), program.c_str(), node_dir.c_str(), static_cast<char*>(nullptr));
  ::perror(program.c_str());
  ::_exit(127);
}

}  // namespace

Result<NodeLock> NodeLock::take(const std::string& node_dir) {
  if (Status made = make_private_dir(node_dir + "/state"); !made) return made.error();
  const int fd = open_lock(node_dir);
  if (fd < 0) return fail(Errc::io_error, lock_path(node_dir) + ": cannot open");
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    auto pid = read_file(lock_path(node_dir), 64);
    return fail(Errc::conflict, node_dir + " is up already (pid " + (pid ? std::to_string(pid_in(*pid)) : "?") + ")",
                "stop that one first, or use trb reload " + node_dir);
  }
  // As long each time: a full disk has room for it where the last one stood. The lock itself is no byte on it.
  std::string text = std::to_string(::getpid());
  text = std::string(kPidDigits - std::min(text.size(), kPidDigits), '0') + text + "\n";
  const bool written = ::pwrite(fd, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written) (void)!::ftruncate(fd, 0);
  return NodeLock(fd);
}

Result<pid_t> NodeLock::holder(const std::string& node_dir) {
  const Error none = fail(Errc::missing, node_dir + " is not up", "start it: trb up " + node_dir);
  const int fd = ::open(lock_path(node_dir).c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return none;
  const bool is_free = ::flock(fd, LOCK_EX | LOCK_NB) == 0;
  ::close(fd);
  auto text = read_file(lock_path(node_dir), 64);
  if (is_free || !text) return none;
  const pid_t pid = pid_in(*text);
  // What a disk that cannot be written to holds is of an earlier start, and may be anybody's by now.
  const auto program = read_file("/proc/" + std::to_string(pid) + "/comm");
  if (pid > 0 && program && *program == "trb\n") return pid;
  return fail(Errc::io_error,
              node_dir + " is up, but " + lock_path(node_dir) + " does not hold its pid: its disk is full",
              "make room there (df -h " + node_dir + ") and start it again: trb up " + node_dir);
}

NodeLock::~NodeLock() {
  if (fd_ >= 0) ::close(fd_);
}

Supervisor::Supervisor(std::string node_dir, std::vector<ServiceProgram> services,
                       std::function<void(const std::string&)> say)
    : node_dir_(std::move(node_dir)), say_(std::move(say)) {
  for (ServiceProgram& one : services) {
    children_.push_back({std::move(one.service), std::move(one.program), 0, {}, {}, {}});
  }
}

bool Supervisor::change(std::vector<ServiceProgram> services) {
  const auto find = [&](const std::string& name) {
    return std::ranges::find(services, name, &ServiceProgram::service);
  };
  for (Child& child : children_) {
    const auto at = find(child.service);
    child.wanted = at != services.end();
    if (child.wanted) child.program = at->program;
    if (child.wanted) services.erase(at);
    if (!child.wanted && child.pid > 0) ::kill(child.pid, SIGTERM);
    if (!child.wanted) say_(child.service + " was taken out, and ends");
  }
  std::erase_if(children_, [](const Child& child) { return !child.wanted && child.pid == 0; });
  signal_all(SIGHUP);
  for (ServiceProgram& one : services) {
    say_(one.service + " is new, and starts");
    children_.push_back({std::move(one.service), std::move(one.program), 0, {}, {}, {}});
  }
  return !services.empty();
}

int Supervisor::run(const Reload& reload, const std::function<bool()>& is_ready) {
  bool ready = false;
  for (;;) {
    const Now now = read_clocks();
    start_due(now);
    const int signal = wait_signal(until_next(now, ready));
    if (signal == SIGTERM || signal == SIGINT) break;
    auto services = signal == SIGHUP ? reload() : std::nullopt;
    if (services && change(std::move(*services))) ready = false;
    reap(read_clocks());
    if (!ready && is_ready()) {
      ready = true;
      say_("ready");
    }
  }
  end_all();
  return 0;
}

Duration Supervisor::until_next(Now now, bool ready) const {
  Duration wait = ready ? Duration(std::chrono::seconds(10)) : kReadyCheck;
  for (const Child& child : children_) {
    if (child.pid == 0) wait = std::min(wait, child.start_at - now.mono);
  }
  return wait;
}

void Supervisor::start_due(Now now) {
  for (Child& child : children_) {
    if (child.pid != 0 || now.mono < child.start_at) continue;
    const pid_t pid = ::fork();
    if (pid == 0) become(child.program, node_dir_);
    child.pid = pid > 0 ? pid : 0;
    child.started = now.mono;
    if (pid < 0) child.start_at = now.mono + kMostWait;
  }
}

void Supervisor::reap(Now now) {
  int status = 0;
  for (pid_t pid = ::waitpid(-1, &status, WNOHANG); pid > 0; pid = ::waitpid(-1, &status, WNOHANG)) {
    for (Child& child : children_) {
      if (child.pid == pid) ended(child, status, now);
    }
  }
  std::erase_if(children_, [](const Child& child) { return !child.wanted && child.pid == 0; });
}

void Supervisor::ended(Child& child, int status, Now now) {
  child.pid = 0;
  if (!child.wanted) return;
  const bool asked = WIFEXITED(status) && WEXITSTATUS(status) == kAgain;
  if (asked || now.mono - child.started > kSettled) child.wait = Duration{};
  child.start_at = now.mono + child.wait;
  child.wait = child.wait == Duration{} ? kFirstWait : std::min(child.wait * 2, kMostWait);
  const std::string how = WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                              : "status " + std::to_string(WEXITSTATUS(status));
  say_(child.service + (asked ? " starts again with the new files" : " ended (" + how + "), starting it again"));
}

void Supervisor::signal_all(int signal) const {
  for (const Child& child : children_) {
    if (child.pid > 0) ::kill(child.pid, signal);
  }
}

void Supervisor::end_all() {
  signal_all(SIGTERM);
  const MonotonicTime end = read_clocks().mono + kGrace;
  const auto any_left = [this] {
    int status = 0;
    for (Child& child : children_) {
      if (child.pid > 0 && ::waitpid(child.pid, &status, WNOHANG) == child.pid) child.pid = 0;
    }
    return std::any_of(children_.begin(), children_.end(), [](const Child& child) { return child.pid > 0; });
  };
  while (any_left() && read_clocks().mono < end) wait_signal(std::chrono::milliseconds(20));
  signal_all(SIGKILL);
}

std::string program_dir() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

void die_with_parent() {
  const pid_t parent = ::getppid();
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  // It may have ended before the kernel was asked.
  if (::getppid() != parent || parent == 1) ::raise(SIGTERM);
}

}  // namespace trb::cli
