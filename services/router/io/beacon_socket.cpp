#include "services/router/io/beacon_socket.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace trb::router {
namespace {

constexpr int kBeaconBatch = 64;
constexpr std::size_t kMaxDatagram = 4096;

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
  [[nodiscard]] int family() const { return storage.ss_family; }
};

/// Of either family, with a scope if it has one; size 0 if `host` is not an address.
Address to_address(const std::string& host, std::uint16_t port) {
  Address out;
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return out;
  std::memcpy(&out.storage, found->ai_addr, found->ai_addrlen);
  out.size = found->ai_addrlen;
  ::freeaddrinfo(found);
  return out;
}

/// IPv6 has no broadcast: the nodes of a network form a group, which must be joined, and sent to by its interface.
void join_group(int fd, const sockaddr_in6& group) {
  const ipv6_mreq request{group.sin6_addr, group.sin6_scope_id};
  ::setsockopt(fd, IPPROTO_IPV6, IPV6_JOIN_GROUP, &request, sizeof request);
}

int bound_socket(const std::string& host, std::uint16_t port) {
  const Address address = to_address(host, port);
  const int fd = ::socket(address.family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  // Several nodes of one machine listen to one broadcast address.
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  ::setsockopt(fd, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
  if (::bind(fd, address.get(), address.size) == 0) {
    const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address.storage);
    if (address.family() == AF_INET6 && IN6_IS_ADDR_MULTICAST(&v6.sin6_addr)) join_group(fd, v6);
    return fd;
  }
  ::close(fd);
  return -1;
}

}  // namespace

Result<std::unique_ptr<BeaconSocket>> BeaconSocket::open(Loop& loop, const std::string& address,
                                                         const std::string& broadcast, std::uint16_t port,
                                                         std::function<void(BytesView)> on_datagram) {
  const int in = bound_socket(broadcast, port);
  if (in < 0) {
    return fail(Errc::io_error,
                "UDP " + broadcast + ":" + std::to_string(port) + ": cannot listen: " + std::strerror(errno),
                "change UDP_PORT in network.json");
  }
  const int out = bound_socket(address, 0);
  if (out < 0) {
    const Error problem =
        fail(Errc::io_error, "UDP from " + address + ": " + std::strerror(errno), "check HOST_INT in network.json");
    ::close(in);
    return problem;
  }
  return std::unique_ptr<BeaconSocket>(new BeaconSocket(loop, in, out, broadcast, port, std::move(on_datagram)));
}

BeaconSocket::BeaconSocket(Loop& loop, int in, int out, std::string broadcast, std::uint16_t port,
                           std::function<void(BytesView)> handler)
    : loop_(loop), in_(in), out_(out), broadcast_(std::move(broadcast)), port_(port), on_datagram_(std::move(handler)) {
  loop_.add_fd(in_, POLLIN, [this](short) { drain(); });
}

BeaconSocket::~BeaconSocket() {
  loop_.remove_fd(in_);
  ::close(in_);
  ::close(out_);
}

void BeaconSocket::send(BytesView datagram) {
  const Address address = to_address(broadcast_, port_);
  ::sendto(out_, datagram.data(), datagram.size(), 0, address.get(), address.size);
}

void BeaconSocket::drain() {
  std::array<char, kMaxDatagram> buffer{};
  for (int i = 0; i < kBeaconBatch; ++i) {
    const ssize_t size = ::recv(in_, buffer.data(), buffer.size(), 0);
    if (size < 0) return;
    on_datagram_({buffer.data(), static_cast<std::size_t>(size)});
  }
}

}  // namespace trb::router
