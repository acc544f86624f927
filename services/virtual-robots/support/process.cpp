#include "services/virtual-robots/support/process.hpp"

#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <system_error>

namespace trb::virtual_robots {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool die_with_parent(int parent) {
  // The order matters: a parent that died before the prctl sends no signal, but then getppid has changed.
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
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
  std::fflush(stdout);
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
