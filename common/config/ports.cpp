#include "common/config/ports.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace trb {
namespace {

class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }

  /// 0 or errno.
  [[nodiscard]] int bind(const sockaddr_in& address) const {
    const int on = 1;
    if (fd_ < 0 || ::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0) return errno;
    return ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  }

 private:
  int fd_;
};

}  // namespace

Status check_tcp_port(const std::string& address, std::uint16_t port) {
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  const std::string name = "TCP " + address + ":" + std::to_string(port);
  if (inet_pton(AF_INET, address.c_str(), &where.sin_addr) != 1) {
    return fail(Errc::bad_value, name + " is no address", "use an IPv4 address");
  }
  const int problem = Socket().bind(where);
  if (problem == 0) return Done{};
  if (problem == EADDRINUSE) {
    return fail(Errc::conflict, name + " is in use by another program",
                "stop that program ('ss -ltnp' shows it) or choose another port");
  }
  if (problem == EACCES) {
    return fail(Errc::not_permitted, name + " may not be used by this user", "choose a port of 1024 or more");
  }
  return fail(Errc::io_error, name + " cannot be bound: " + std::strerror(problem), "choose another address or port");
}

}  // namespace trb
