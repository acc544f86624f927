#include "services/virtual-robots/support/socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots {
namespace {

void require(bool condition, const char* what) {
  if (!condition) throw std::system_error(errno, std::generic_category(), what);
}

sockaddr_in to_sockaddr(const Endpoint& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  if (inet_pton(AF_INET, endpoint.address.c_str(), &address.sin_addr) != 1) {
    throw std::system_error(EINVAL, std::generic_category(), "address " + endpoint.address);
  }
  return address;
}

void bind_to(const Fd& socket, const Endpoint& where) {
  const sockaddr_in address = to_sockaddr(where);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  require(::bind(socket.get(), generic, sizeof address) == 0, "bind");
}

void send_without_delay(const Fd& socket) {
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

Fd new_socket(int kind = SOCK_STREAM) {
  Fd socket(::socket(AF_INET, kind | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  require(static_cast<bool>(socket), "socket");
  return socket;
}

Transfer outcome_of(ssize_t result) {
  if (result > 0) return {Transfer::Kind::done, static_cast<std::size_t>(result)};
  const bool later = result < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  return {later ? Transfer::Kind::later : Transfer::Kind::closed, 0};
}

}  // namespace

Fd::Fd(Fd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Fd& Fd::operator=(Fd&& other) noexcept {
  if (this != &other) {
    reset();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

Fd::~Fd() {
  reset();
}

void Fd::reset() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto port = parse_integer(text.substr(colon + 1));
  Endpoint endpoint{std::string(text.substr(0, colon)), 0};
  in_addr ignored{};
  if (!port || *port < 1 || *port > 65535) return std::nullopt;
  if (inet_pton(AF_INET, endpoint.address.c_str(), &ignored) != 1) return std::nullopt;
  endpoint.port = static_cast<std::uint16_t>(*port);
  return endpoint;
}

Fd listen_on(const Endpoint& where) {
  Fd socket = new_socket();
  const int on = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  bind_to(socket, where);
  require(::listen(socket.get(), 16) == 0, "listen");
  return socket;
}

Fd bind_datagrams(const Endpoint& where) {
  Fd socket = new_socket(SOCK_DGRAM);
  bind_to(socket, where);
  return socket;
}

std::uint16_t port_of(const Fd& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  require(::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0, "getsockname");
  return ntohs(address.sin_port);
}

Fd accept_client(const Fd& listener) {
  Fd client(::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (client) send_without_delay(client);
  return client;
}

Fd start_connect(const Endpoint& to, const std::string& from) {
  Fd socket = new_socket();
  send_without_delay(socket);
  if (!from.empty()) bind_to(socket, {from, 0});
  const sockaddr_in address = to_sockaddr(to);
  const int result = ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  require(result == 0 || errno == EINPROGRESS, "connect");
  return socket;
}

int connect_result(const Fd& socket) {
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

Transfer read_some(const Fd& socket, std::string& into, std::size_t most) {
  std::array<char, 16384> buffer;
  const ssize_t result = ::read(socket.get(), buffer.data(), std::min(most, buffer.size()));
  if (result > 0) into.append(buffer.data(), static_cast<std::size_t>(result));
  return outcome_of(result);
}

Transfer write_some(const Fd& socket, std::string_view bytes) {
  if (bytes.empty()) return {Transfer::Kind::done, 0};
  return outcome_of(::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

}  // namespace trb::virtual_robots
