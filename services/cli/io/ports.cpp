#include "services/cli/io/ports.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include "common/transport/loop.hpp"

namespace trb::cli {
using op::AddressProbe;
using op::LargeDatagram;
using op::Port;

namespace {

constexpr Duration kConnect = std::chrono::milliseconds(1500);
constexpr std::uint16_t kUnusedPort = 33437;  // traceroute's range: nobody listens there
constexpr int kIpv4Headers = 28;
constexpr int kIpv6Headers = 48;
constexpr int kMostData = 1472;  // an Ethernet frame's

struct Endpoint {
  sockaddr_storage address{};
  socklen_t size = 0;
};

std::optional<Endpoint> resolve(const HostPort& at) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (::getaddrinfo(at.host.c_str(), at.port.c_str(), &hints, &list) != 0) return std::nullopt;
  Endpoint out;
  std::memcpy(&out.address, list->ai_addr, list->ai_addrlen);
  out.size = list->ai_addrlen;
  ::freeaddrinfo(list);
  return out;
}

Port port_of(int problem) {
  if (problem == ECONNREFUSED) return Port::refused;
  return problem == ENETUNREACH || problem == EADDRNOTAVAIL ? Port::no_route : Port::no_answer;
}

/// One connection on its way: connecting, then waiting for a ZMTP signature.
class Knock {
 public:
  explicit Knock(const std::string& address) {
    const auto to = resolve(split_address(address));
    if (!to) {
      end(Port::no_route);
      return;
    }
    fd_ = ::socket(to->address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd_ < 0) return;
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to->address), to->size) != 0 && errno != EINPROGRESS)
      end(port_of(errno));
  }
  ~Knock() {
    if (fd_ >= 0) ::close(fd_);
  }
  Knock(const Knock&) = delete;
  Knock& operator=(const Knock&) = delete;

  [[nodiscard]] bool done() const { return fd_ < 0; }
  [[nodiscard]] Port result() const { return done() ? result_ : connected_ ? Port::not_zmtp : Port::no_answer; }
  [[nodiscard]] pollfd wanted() const { return {fd_, static_cast<short>(connected_ ? POLLIN : POLLOUT), 0}; }

  void on_ready() {
    if (!connected_) {
      int problem = 0;
      socklen_t size = sizeof problem;
      ::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &problem, &size);
      if (problem != 0) return end(port_of(problem));
      connected_ = true;
      return;
    }
    unsigned char first = 0;
    end(::recv(fd_, &first, 1, 0) == 1 && first == 0xff ? Port::zmtp : Port::not_zmtp);
  }

 private:
  void end(Port result) {
    result_ = result;
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  int fd_ = -1;
  bool connected_ = false;
  Port result_ = Port::not_tried;
};

void wait_for(const std::vector<std::unique_ptr<Knock>>& knocks) {
  const MonotonicTime end = read_clocks().mono + kConnect;
  for (;;) {
    std::vector<pollfd> waiting;
    std::vector<Knock*> who;
    for (const auto& knock : knocks) {
      if (knock->done()) continue;
      waiting.push_back(knock->wanted());
      who.push_back(knock.get());
    }
    const Duration left = end - read_clocks().mono;
    if (waiting.empty() || left <= Duration::zero()) return;
    ::poll(waiting.data(), waiting.size(),
           static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
    for (std::size_t i = 0; i < who.size(); ++i) {
      if (waiting[i].revents != 0) who[i]->on_ready();
    }
  }
}

/// True if the machine answered that nobody listens there, so the datagram arrived.
bool arrives(int fd, std::size_t size) {
  const std::string data(size, '\0');
  for (int i = 0; i < 2; ++i) {
    if (::send(fd, data.data(), data.size(), 0) < 0 && errno == ECONNREFUSED) return true;
    pollfd item{fd, POLLIN, 0};
    if (::poll(&item, 1, 250) <= 0) continue;
    char byte = 0;
    if (::recv(fd, &byte, 1, 0) < 0 && errno == ECONNREFUSED) return true;
  }
  return false;
}

std::size_t prefix_bits_equal(const unsigned char* a, const unsigned char* b, const unsigned char* mask,
                              std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    if ((a[i] & mask[i]) != (b[i] & mask[i])) return 0;
  }
  return 1;
}

bool in_network(const sockaddr_storage& address, const ifaddrs& entry) {
  if (entry.ifa_addr == nullptr || entry.ifa_netmask == nullptr) return false;
  if (entry.ifa_addr->sa_family != address.ss_family) return false;
  const auto bytes4 = [](const void* at) {
    return reinterpret_cast<const unsigned char*>(&static_cast<const sockaddr_in*>(at)->sin_addr);
  };
  const auto bytes6 = [](const void* at) {
    return reinterpret_cast<const unsigned char*>(&static_cast<const sockaddr_in6*>(at)->sin6_addr);
  };
  if (address.ss_family == AF_INET)
    return prefix_bits_equal(bytes4(&address), bytes4(entry.ifa_addr), bytes4(entry.ifa_netmask), 4) != 0;
  return address.ss_family == AF_INET6 &&
         prefix_bits_equal(bytes6(&address), bytes6(entry.ifa_addr), bytes6(entry.ifa_netmask), 16) != 0;
}

}  // namespace

HostPort split_address(const std::string& address) {
  const auto colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0) return {};
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

void probe_ports(std::vector<AddressProbe>& probes) {
  std::vector<std::unique_ptr<Knock>> knocks;
  knocks.reserve(probes.size());
  for (const AddressProbe& probe : probes) knocks.push_back(std::make_unique<Knock>(probe.address));
  wait_for(knocks);
  for (std::size_t i = 0; i < probes.size(); ++i) probes[i].port = knocks[i]->result();
}

Port probe_port(const std::string& address) {
  std::vector<AddressProbe> one(1);
  one[0].address = address;
  probe_ports(one);
  return one[0].port;
}

LargeDatagram probe_large_datagrams(const std::string& address) {
  const auto to = resolve({split_address(address).host, std::to_string(kUnusedPort)});
  if (!to) return LargeDatagram::not_known;
  const bool v6 = to->address.ss_family == AF_INET6;
  const int fd = ::socket(to->address.ss_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return LargeDatagram::not_known;
  // "Probe": do not fragment, and do not believe what is remembered of the path.
  const int whole = v6 ? static_cast<int>(IPV6_PMTUDISC_PROBE) : static_cast<int>(IP_PMTUDISC_PROBE);
  ::setsockopt(fd, v6 ? IPPROTO_IPV6 : IPPROTO_IP, v6 ? IPV6_MTU_DISCOVER : IP_MTU_DISCOVER, &whole, sizeof whole);
  LargeDatagram out = LargeDatagram::not_known;
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to->address), to->size) == 0 && arrives(fd, 32)) {
    int mtu = 0;
    socklen_t size = sizeof mtu;
    ::getsockopt(fd, v6 ? IPPROTO_IPV6 : IPPROTO_IP, v6 ? IPV6_MTU : IP_MTU, &mtu, &size);
    const int headers = v6 ? kIpv6Headers : kIpv4Headers;
    const int most = std::clamp(mtu - headers, 512, kMostData);
    out = arrives(fd, static_cast<std::size_t>(most)) ? LargeDatagram::passed : LargeDatagram::lost;
  }
  ::close(fd);
  return out;
}

bool in_own_subnet(const std::string& address) {
  const auto to = resolve(split_address(address));
  ifaddrs* list = nullptr;
  if (!to || ::getifaddrs(&list) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (in_network(to->address, *entry)) return true;
  }
  return false;
}

}  // namespace trb::cli
