#include "services/ros-bridge/io/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "common/base/files.hpp"

namespace trb::ros {
namespace {

constexpr int kInChild = 3;
constexpr std::size_t kMaxUnsent = 8U << 20U;
constexpr Duration kPause = std::chrono::seconds(2);
constexpr Duration kSoon = std::chrono::milliseconds(100);
constexpr int kMasterIsNew = 3;
constexpr int kShutDown = 4;

[[noreturn]] void become(const std::vector<std::string>& command, int socket) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // ROS writes reports to its standard output.
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  if (socket == kInChild) {
    ::fcntl(socket, F_SETFD, 0);
  } else {
    ::dup2(socket, kInChild);
  }
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

WorkerProcess::WorkerProcess(Service& service, BridgeCore& core, std::vector<std::string> command)
    : service_(service), core_(core), command_(std::move(command)) {
  service_.after_sends([this] {
    if (const WorkerOutput output = core_.take_worker_output(); !output.empty()) carry_out(output);
  });
  service_.timer([this] { return pid_ == 0 ? std::optional(start_at_) : std::nullopt; },
                 [this](Now now) {
                   if (pid_ == 0 && now.mono >= start_at_) start(now);
                 });
}

WorkerProcess::~WorkerProcess() {
  end();
}

void WorkerProcess::start(Now now) {
  if (!file_exists(command_[0])) {
    return ended("this build has no ROS: " + command_[0] + " is not there; build with -DTRB_WITH_ROS=ON", kPause * 15);
  }
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return ended("no socket for a worker", kPause);
  pid_ = ::fork();
  if (pid_ == 0) become(command_, pair[1]);
  ::close(pair[1]);
  fd_ = Descriptor(pair[0]);
  is_full_ = false;
  if (pid_ < 0) {
    pid_ = 0;
    end();
    return ended("no process for a worker", kPause);
  }
  ::fcntl(fd_.get(), F_SETFL, O_NONBLOCK);
  watch();
  service_.step([this, now](Now, Outbox& out) { core_.on_worker_started(now, out); });
}

void WorkerProcess::watch() {
  const auto events = static_cast<short>(unsent_.empty() ? POLLIN : POLLIN | POLLOUT);
  service_.watch(fd_.get(), events, [this](short heard) { on_ready(heard); });
}

void WorkerProcess::carry_out(const WorkerOutput& output) {
  unsent_ += output.bytes;
  if (!fd_) {
    unsent_.clear();
    return;
  }
  if (output.kill) {
    end();
    start_at_ = now().mono + kPause;
    return;
  }
  // A worker that reads nothing hangs. What it has of the first message must not be followed by a later one.
  if (unsent_.size() > kMaxUnsent) {
    is_full_ = true;
    ::shutdown(fd_.get(), SHUT_RDWR);  // its end is read next
    return unsent_.clear();
  }
  if (!output.bytes.empty()) flush();
}

void WorkerProcess::flush() {
  const bool waited = !unsent_.empty();
  while (!unsent_.empty()) {
    const ssize_t sent = ::send(fd_.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL);
    if (sent <= 0) break;
    unsent_.erase(0, static_cast<std::size_t>(sent));
  }
  if (waited) watch();
}

void WorkerProcess::on_ready(short events) {
  if ((events & POLLOUT) != 0) flush();
  if ((events & (POLLIN | POLLHUP | POLLERR)) == 0) return;
  Bytes bytes(65536, '\0');
  const ssize_t size = ::recv(fd_.get(), bytes.data(), bytes.size(), 0);
  if (size > 0) {
    bytes.resize(static_cast<std::size_t>(size));
    service_.step([this, &bytes](Now now, Outbox& out) { core_.on_worker_bytes(bytes, now, out); });
    return;
  }
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  const auto status = end();
  if (is_full_) return ended("the ROS worker takes no more orders", kPause);
  if (status == kMasterIsNew) return ended("the ROS master was started again", kSoon);
  // Two of one name would end each other without a pause.
  if (status == kShutDown) {
    return ended(
        "ROS node " + command_[3] + " was shut down: by rosnode kill, or another node took its name; end that one",
        kPause * 5);
  }
  ended("the ROS worker has ended" + (status ? " with status " + std::to_string(*status) : std::string()), kPause);
}

std::optional<int> WorkerProcess::end() {
  if (fd_) {
    service_.unwatch(fd_.get());
    fd_.reset();
  }
  unsent_.clear();
  if (pid_ == 0) return std::nullopt;
  // One that has ended keeps its status; a stopped one ends, too.
  ::kill(pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = 0;
  return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt;
}

void WorkerProcess::ended(const std::string& reason, Duration pause) {
  start_at_ = now().mono + pause;
  service_.step([&](Now now, Outbox& out) { core_.on_worker_ended(reason, now, out); });
}

}  // namespace trb::ros
