#include "services/mode-adapter/io/udp.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace trb::adapter {
namespace {

bool not_now() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS;
}

Error last_error() {
  return fail(Errc::io_error, std::strerror(errno));
}

}  // namespace

Result<Descriptor> udp_dial(const std::string& address, std::uint16_t port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &at.sin_addr) != 1) {
    return fail(Errc::bad_value, "'" + address + "' is no IPv4 address", "give four numbers, such as 192.168.1.1");
  }
  Descriptor fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0) return last_error();
  return fd;
}

Result<Datagram> udp_read(int fd, char* buffer, std::size_t size) {
  const ssize_t got = ::recv(fd, buffer, size, 0);
  if (got >= 0) return Datagram{true, static_cast<std::size_t>(got)};
  if (not_now()) return Datagram{};
  return last_error();
}

Status udp_write(int fd, BytesView bytes) {
  if (::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0 || not_now()) return Done{};
  return last_error();
}

}  // namespace trb::adapter
