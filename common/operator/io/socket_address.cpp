#include "common/operator/io/socket_address.hpp"

#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>

#include <cstring>
#include <memory>

#include "common/config/interfaces.hpp"

namespace trb::op {
namespace {

bool equal_under(const unsigned char* a, const unsigned char* b, const unsigned char* mask, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    if ((a[i] & mask[i]) != (b[i] & mask[i])) return false;
  }
  return true;
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
    return equal_under(bytes4(&address), bytes4(entry.ifa_addr), bytes4(entry.ifa_netmask), 4);
  return address.ss_family == AF_INET6 &&
         equal_under(bytes6(&address), bytes6(entry.ifa_addr), bytes6(entry.ifa_netmask), 16);
}

}  // namespace

std::optional<SocketAddress> socket_address(const std::string& address, std::optional<std::uint16_t> port) {
  const Endpoint at = split_endpoint(address);
  if (at.host.empty()) return std::nullopt;
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const std::string service = std::to_string(port.value_or(at.port));
  if (::getaddrinfo(at.host.c_str(), service.c_str(), &hints, &list) != 0) return std::nullopt;
  SocketAddress out;
  std::memcpy(&out.address, list->ai_addr, list->ai_addrlen);
  out.size = list->ai_addrlen;
  ::freeaddrinfo(list);
  return out;
}

bool in_own_subnet(const std::string& address) {
  const auto to = socket_address(address);
  ifaddrs* list = nullptr;
  if (!to || ::getifaddrs(&list) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (in_network(to->address, *entry)) return true;
  }
  return false;
}

}  // namespace trb::op
