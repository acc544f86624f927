#include "services/router/io/beacon_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace trb::router {
namespace {

constexpr int kBatch = 64;
constexpr std::size_t kMaxDatagram = 4096;

sockaddr_in to_sockaddr(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  ::inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  return address;
}

int bound_socket(const std::string& host, std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  // Several nodes of one machine listen to one broadcast.
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  ::setsockopt(fd, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
  const sockaddr_in address = to_sockaddr(host, port);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
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
  const sockaddr_in address = to_sockaddr(broadcast_, port_);
  ::sendto(out_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

void BeaconSocket::drain() {
  std::array<char, kMaxDatagram> buffer{};
  for (int i = 0; i < kBatch; ++i) {
    const ssize_t size = ::recv(in_, buffer.data(), buffer.size(), 0);
    if (size < 0) return;
    on_datagram_({buffer.data(), static_cast<std::size_t>(size)});
  }
}

}  // namespace trb::router
