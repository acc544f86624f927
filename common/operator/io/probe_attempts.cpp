#include "common/operator/io/probe_attempts.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "common/operator/io/socket_address.hpp"

namespace trb::op {
namespace {

constexpr Duration kConnect = std::chrono::milliseconds(1500);
constexpr Duration kDatagram = std::chrono::milliseconds(250);
constexpr int kTries = 2;
constexpr std::uint16_t kUnusedPort = 33437;  // traceroute's range: nothing listens there
constexpr std::size_t kSmall = 32;
constexpr int kIpv4Headers = 28;
constexpr int kIpv6Headers = 48;
constexpr int kMostData = 1472;  // an Ethernet frame's

Port port_of(int problem) {
  if (problem == ECONNREFUSED) return Port::refused;
  return problem == ENETUNREACH || problem == EADDRNOTAVAIL ? Port::no_route : Port::no_answer;
}

/// Connecting, then waiting for a ZMTP signature.
class Connection final : public Attempt {
 public:
  Connection(const std::string& address, MonotonicTime now) { begin(address, now); }

  void on_ready(MonotonicTime /*now*/) override {
    if (connected_) {
      unsigned char first = 0;
      return end_with(::recv(fd(), &first, 1, 0) == 1 && first == 0xff ? Port::zmtp : Port::not_zmtp);
    }
    int problem = 0;
    socklen_t size = sizeof problem;
    ::getsockopt(fd(), SOL_SOCKET, SO_ERROR, &problem, &size);
    if (problem != 0) return end_with(port_of(problem));
    connected_ = true;
    wait_for(POLLIN, deadline());
  }
  void on_late(MonotonicTime /*now*/) override { end_with(connected_ ? Port::not_zmtp : Port::no_answer); }
  void write_result(AddressProbe& probe) const override { probe.port = result_; }

 private:
  void begin(const std::string& address, MonotonicTime now) {
    const auto to = socket_address(address);
    if (!to) return end_with(Port::no_route);
    open(::socket(to->family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (fd() < 0) return end_with(Port::not_tried);
    if (::connect(fd(), to->data(), to->size) != 0 && errno != EINPROGRESS) return end_with(port_of(errno));
    wait_for(POLLOUT, now + kConnect);
  }

  void end_with(Port result) {
    result_ = result;
    end();
  }

  Port result_ = Port::not_tried;
  bool connected_ = false;
};

/// Small ones, and if one of them arrives, the largest that should pass.
class Datagrams final : public Attempt {
 public:
  Datagrams(const std::string& address, MonotonicTime now) { begin(address, now); }

  void on_ready(MonotonicTime now) override {
    char byte = 0;
    const bool refused = ::recv(fd(), &byte, 1, 0) < 0 && errno == ECONNREFUSED;
    refused ? arrived(now) : send(now);
  }
  void on_late(MonotonicTime now) override { send(now); }
  void write_result(AddressProbe& probe) const override { probe.large = result_; }

 private:
  void begin(const std::string& address, MonotonicTime now) {
    const auto to = socket_address(address, kUnusedPort);
    if (to) open(::socket(to->family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (fd() < 0) return end();
    v6_ = to->family() == AF_INET6;
    // "Probe": do not fragment, and ignore the cached path MTU.
    static_assert(static_cast<int>(IP_PMTUDISC_PROBE) == static_cast<int>(IPV6_PMTUDISC_PROBE));
    const int whole = IP_PMTUDISC_PROBE;
    ::setsockopt(fd(), level(), v6_ ? IPV6_MTU_DISCOVER : IP_MTU_DISCOVER, &whole, sizeof whole);
    if (::connect(fd(), to->data(), to->size) != 0) return end();
    send(now);
  }

  void send(MonotonicTime now) {
    if (tries_++ == kTries) return end();
    const std::string data(size_, '\0');
    // The answer to the last one: that nothing listens there.
    if (::send(fd(), data.data(), data.size(), 0) < 0 && errno == ECONNREFUSED) return arrived(now);
    wait_for(POLLIN, now + kDatagram);
  }

  void arrived(MonotonicTime now) {
    if (size_ != kSmall) {
      result_ = LargeDatagram::passed;
      return end();
    }
    result_ = LargeDatagram::lost;
    size_ = largest();
    tries_ = 0;
    send(now);
  }

  [[nodiscard]] std::size_t largest() const {
    int mtu = 0;
    socklen_t size = sizeof mtu;
    ::getsockopt(fd(), level(), v6_ ? IPV6_MTU : IP_MTU, &mtu, &size);
    return static_cast<std::size_t>(std::clamp(mtu - (v6_ ? kIpv6Headers : kIpv4Headers), 512, kMostData));
  }
  [[nodiscard]] int level() const { return v6_ ? IPPROTO_IPV6 : IPPROTO_IP; }

  LargeDatagram result_ = LargeDatagram::not_known;
  std::size_t size_ = kSmall;
  int tries_ = 0;
  bool v6_ = false;
};

}  // namespace

std::unique_ptr<Attempt> try_connection(const std::string& address, MonotonicTime now) {
  return std::make_unique<Connection>(address, now);
}

std::unique_ptr<Attempt> try_datagrams(const std::string& address, MonotonicTime now) {
  return std::make_unique<Datagrams>(address, now);
}

}  // namespace trb::op
