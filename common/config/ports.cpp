#include "common/config/ports.hpp"

#include <netdb.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "common/base/descriptor.hpp"
#include "common/config/interfaces.hpp"

namespace trb {
namespace {

/// 0 or errno.
int try_to_bind(const addrinfo& address) {
  const Descriptor socket(::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  if (!socket || ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0) return errno;
  return ::bind(socket.get(), address.ai_addr, address.ai_addrlen) == 0 ? 0 : errno;
}

}  // namespace

Status check_tcp_port(const std::string& address, std::uint16_t port) {
  const std::string name = "TCP " + join_host_port(address, port);
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    return fail(Errc::bad_value, name + " is no address", "use an IPv4 or IPv6 address");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> where(found, freeaddrinfo);
  const int problem = try_to_bind(*where);
  if (problem == 0) return Done{};
  if (problem == EADDRINUSE) {
    return fail(Errc::conflict, name + " is in use by another program",
                "stop that program ('ss -ltnp' shows it) or choose another port");
  }
  if (problem == EACCES) {
    return fail(Errc::not_permitted, name + " may not be used by this user", "choose a port of 1024 or more");
  }
  if (problem == EADDRNOTAVAIL) {
    return fail(Errc::missing, name + " cannot be bound: the address is not ready", "wait, or look at 'ip address'");
  }
  return fail(Errc::io_error, name + " cannot be bound: " + std::strerror(problem), "choose another address or port");
}

}  // namespace trb
