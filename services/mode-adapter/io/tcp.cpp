#include "services/mode-adapter/io/tcp.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace trb::adapter {
namespace {

constexpr int kBacklog = 8;
constexpr int kKeepAliveIdle_s = 2;
constexpr int kKeepAliveInterval_s = 1;
constexpr int kKeepAliveProbes = 3;
constexpr int kUserTimeout_ms = 5000;

Error system_error(const std::string& what, int error) {
  return fail(Errc::io_error, what.empty() ? std::strerror(error) : what + ": " + std::strerror(error));
}

void set(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

Result<sockaddr_in> address_of(const std::string& address, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &out.sin_addr) == 1) return out;
  return fail(Errc::bad_value, "'" + address + "' is no IPv4 address", "give four numbers, such as 192.168.1.20");
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

Descriptor tcp_socket() {
  return Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

Result<Descriptor> tcp_listen(const std::string& address, std::uint16_t port) {
  const auto at = address_of(address, port);
  if (!at) return at.error();
  Descriptor fd = tcp_socket();
  const std::string place = address + ":" + std::to_string(port);
  if (!fd) return system_error(place, errno);
  set(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  if (::bind(fd.get(), generic(*at), sizeof(sockaddr_in)) != 0) return system_error(place, errno);
  if (::listen(fd.get(), kBacklog) != 0) return system_error(place, errno);
  return fd;
}

std::uint16_t local_port(int fd) {
  sockaddr_in at{};
  socklen_t size = sizeof at;
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size);
  return ntohs(at.sin_port);
}

Result<Descriptor> tcp_dial(const std::string& address, std::uint16_t port) {
  const auto at = address_of(address, port);
  if (!at) return at.error();
  Descriptor fd = tcp_socket();
  if (!fd) return system_error("", errno);
  watch_over(fd.get());
  const int begun = ::connect(fd.get(), generic(*at), sizeof(sockaddr_in));
  if (begun != 0 && errno != EINPROGRESS) return system_error("", errno);
  return fd;
}

Status tcp_connected(int fd) {
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error == 0) return Done{};
  return system_error("", error);
}

Accepted tcp_accept(int listener) {
  sockaddr_in peer{};
  socklen_t size = sizeof peer;
  Descriptor fd(::accept4(listener, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!fd) return {};
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &peer.sin_addr, text.data(), text.size());
  return {std::move(fd), text.data()};
}

bool tcp_has_ended(int fd) {
  pollfd look{fd, POLLRDHUP, 0};
  return ::poll(&look, 1, 0) > 0;
}

void watch_over(int fd) {
  set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdle_s);
  set(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveInterval_s);
  set(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveProbes);
  set(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, kUserTimeout_ms);
}

Result<Transfer> tcp_read(int fd, char* buffer, std::size_t size) {
  const ssize_t got = ::recv(fd, buffer, size, 0);
  if (got >= 0) return Transfer{static_cast<std::size_t>(got), got == 0};
  if (would_block()) return Transfer{};
  return system_error("", errno);
}

Result<Transfer> tcp_write(int fd, BytesView bytes) {
  const ssize_t put = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (put >= 0) return Transfer{static_cast<std::size_t>(put), false};
  if (would_block()) return Transfer{};
  return system_error("", errno);
}

}  // namespace trb::adapter
