#include "services/cli/conform/robot_end.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "common/transport/loop.hpp"

namespace trb::cli::conform {
namespace {

Error io_error(const std::string& what, const std::string& hint) {
  return fail(Errc::io_error, what + ": " + std::strerror(errno), hint);
}

/// The events that came within the time; 0 for none.
short wait_for(int fd, short events, Duration patience) {
  const MonotonicTime end = read_clocks().mono + patience;
  while (true) {
    const Duration left = std::max(Duration::zero(), end - read_clocks().mono);
    pollfd item{fd, events, 0};
    const auto most = std::chrono::ceil<std::chrono::milliseconds>(left).count();
    if (::poll(&item, 1, static_cast<int>(most)) > 0) return item.revents;
    if (errno != EINTR || left == Duration::zero()) return 0;
  }
}

void close_fd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

}  // namespace

RobotEnd::~RobotEnd() {
  close_fd(robot_);
  close_fd(listener_);
}

Status RobotEnd::listen(const std::string& address, std::uint16_t port) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  const std::string at = address + ":" + std::to_string(port);
  if (::inet_pton(AF_INET, address.c_str(), &where.sin_addr) != 1) {
    return fail(Errc::bad_value, at + ": no IPv4 address", "write, for example, --listen 192.168.1.10:40000");
  }
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(listener_, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0 || ::listen(listener_, 4) != 0) {
    return io_error(at, "stop the node that listens there (trb up), or use --listen with an address of this machine");
  }
  return Done{};
}

std::uint16_t RobotEnd::port() const {
  sockaddr_in where{};
  socklen_t size = sizeof where;
  if (::getsockname(listener_, reinterpret_cast<sockaddr*>(&where), &size) != 0) return 0;
  return ntohs(where.sin_port);
}

bool RobotEnd::accept(const std::string& from, Duration patience) {
  const MonotonicTime end = read_clocks().mono + patience;
  while (true) {
    const Duration left = std::max(Duration::zero(), end - read_clocks().mono);
    if (wait_for(listener_, POLLIN, left) == 0) return false;
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    const int fd = ::accept4(listener_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) continue;
    std::array<char, INET_ADDRSTRLEN> host{};
    ::inet_ntop(AF_INET, &peer.sin_addr, host.data(), host.size());
    if (!from.empty() && from != host.data()) {
      ::close(fd);
      continue;
    }
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    drop();
    robot_ = fd;
    return true;
  }
}

void RobotEnd::drop() {
  close_fd(robot_);
}

bool RobotEnd::read(std::string& into, Duration patience) {
  if (robot_ < 0) return false;
  if (wait_for(robot_, POLLIN, patience) == 0) return true;
  std::array<char, 65536> buffer;
  const ssize_t got = ::recv(robot_, buffer.data(), buffer.size(), 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return true;
  if (got <= 0) return false;
  into.append(buffer.data(), static_cast<std::size_t>(got));
  return true;
}

bool RobotEnd::write(const std::string& bytes, std::string& heard, Duration patience) {
  std::size_t done = 0;
  while (robot_ >= 0 && done < bytes.size()) {
    const short ready = wait_for(robot_, POLLIN | POLLOUT, patience);
    if (ready == 0) return false;
    if ((ready & POLLIN) != 0 && !read(heard, Duration::zero())) return false;
    if ((ready & POLLOUT) == 0) continue;
    const ssize_t put = ::send(robot_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (put > 0) done += static_cast<std::size_t>(put);
    if (put < 0 && errno != EAGAIN && errno != EINTR) return false;
  }
  return done == bytes.size();
}

void pause(Duration duration) {
  ::poll(nullptr, 0, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(duration).count()));
}

}  // namespace trb::cli::conform
