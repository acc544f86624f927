#include "services/virtual-robots/support/process.hpp"

#include <limits.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <system_error>

namespace trb::virtual_robots {
namespace {

/** The lines on their way to stdout. */
class LineWriter {
 public:
  void add(std::string_view line) {
    constexpr std::size_t kMostKept = std::size_t{4} * 1024 * 1024;
    if (broken_) return;
    flush();
    if (kept_.size() + line.size() > kMostKept) {
      ++lost_;
      return;
    }
    if (lost_ > 0) kept_ += "lines_lost " + std::to_string(lost_) + "\n";
    lost_ = 0;
    kept_.append(line).append("\n");
    flush();
  }

  void flush() {
    std::size_t written = 0;
    while (written < kept_.size() && takes_more()) {
      // A pipe that poll reports as writable takes this much without blocking.
      const ssize_t count = ::write(1, kept_.data() + written, std::min<std::size_t>(kept_.size() - written, PIPE_BUF));
      if (count < 0 && errno != EINTR && errno != EAGAIN) broken_ = true;
      if (count <= 0) break;
      written += static_cast<std::size_t>(count);
    }
    kept_.erase(0, broken_ ? kept_.size() : written);
  }

  bool waiting() const { return !kept_.empty(); }

 private:
  static bool takes_more() {
    pollfd entry{1, POLLOUT, 0};
    return ::poll(&entry, 1, 0) == 1 && (entry.revents & (POLLOUT | POLLERR)) != 0;
  }

  std::string kept_;
  std::size_t lost_ = 0;
  bool broken_ = false;
};

/** The process's only one, as there is only one stdout. */
LineWriter& stdout_lines() {
  static LineWriter writer;
  return writer;
}

}  // namespace

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool die_with_parent(int parent) {
  // The order matters: no signal comes if the parent died before the prctl, but then getppid has changed.
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  return ::getppid() == parent;
}

Fd catch_end_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  ::sigprocmask(SIG_BLOCK, &signals, nullptr);
  Fd fd(::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!fd) throw std::system_error(errno, std::generic_category(), "signalfd");
  return fd;
}

void print_line(std::string_view line) {
  stdout_lines().add(line);
}

int stdout_to_poll() {
  return stdout_lines().waiting() ? 1 : -1;
}

void flush_lines() {
  stdout_lines().flush();
}

int poll_timeout(double now, double deadline) {
  constexpr double kLongest = 60.0;
  const double wait = std::clamp(deadline - now, 0.0, kLongest);
  return static_cast<int>(std::ceil(wait * 1000.0));
}

std::vector<std::string> StdinLines::read() {
  constexpr std::size_t kLongestLine = 1 << 20;
  char bytes[4096];
  const ssize_t count = ::read(0, bytes, sizeof bytes);
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return {};
  ended_ = count <= 0;
  if (ended_) return {};
  buffer_.append(bytes, static_cast<std::size_t>(count));
  std::vector<std::string> lines;
  for (std::size_t end; (end = buffer_.find('\n')) != std::string::npos; buffer_.erase(0, end + 1)) {
    lines.push_back(buffer_.substr(0, end));
  }
  if (buffer_.size() > kLongestLine) buffer_.clear();
  return lines;
}

}  // namespace trb::virtual_robots
