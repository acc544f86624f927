#include "common/config/interfaces.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

constexpr const char* kLoopbackBroadcast = "127.255.255.255";

std::string text_of(const sockaddr* address) {
  if (address == nullptr) return {};
  char out[INET6_ADDRSTRLEN] = {};
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, out, sizeof out);
  } else if (address->sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, out, sizeof out);
  }
  return out;
}

bool is_v6(const std::string& address) {
  return address.find(':') != std::string::npos;
}

bool is_link_local(std::string_view address) {
  return address.starts_with("fe80:");
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

Interface interface_of(const ifaddrs& entry) {
  Interface out{entry.ifa_name, text_of(entry.ifa_addr), {}, (entry.ifa_flags & IFF_UP) != 0};
  if (is_link_local(out.address)) out.address += "%" + out.name;
  if (is_loopback(out.address)) {
    out.broadcast = kLoopbackBroadcast;
  } else if (is_v6(out.address)) {
    if ((entry.ifa_flags & IFF_MULTICAST) != 0) out.broadcast = std::string(kBeaconGroup) + "%" + out.name;
  } else if ((entry.ifa_flags & IFF_BROADCAST) != 0) {
    out.broadcast = text_of(entry.ifa_broadaddr);
  }
  return out;
}

std::string list_of(const std::vector<Interface>& known) {
  std::vector<std::string> words;
  words.reserve(known.size());
  for (const Interface& interface : known) {
    words.push_back(interface.name + " (" + (interface.address.empty() ? "no address" : interface.address) +
                    (interface.up ? ")" : ", down)"));
  }
  return "use one of: " + join(words);
}

/// The display names that Windows shows are not names of interfaces, not even there.
bool is_windows_name(std::string_view name) {
  return name.starts_with("Wi-Fi") || name.starts_with("Ethernet") || name.starts_with("Local Area");
}

bool has_name(const std::vector<Interface>& known, const std::string& name) {
  return std::any_of(known.begin(), known.end(), [&](const Interface& one) { return one.name == name; });
}

Resolved refuse(std::string what, std::string hint, bool may_come = false) {
  return {{}, {}, std::move(what), std::move(hint), {}, may_come};
}

Resolved missing_interface(const std::string& name, const std::vector<Interface>& known) {
  if (!is_windows_name(name)) {
    return refuse("there is no interface or address '" + name + "' here", list_of(known),
                  !is_ipv4(name) && !is_ipv6(name));
  }
  return refuse("'" + name + "' is the name that Windows shows, this machine has no such interface",
                "put the name that Linux gives it, usually 'eth0', 'enp3s0' or 'wlan0' ('ip address' shows it), or its "
                "address; " +
                    list_of(known));
}

Resolved found(const Interface& interface, const std::vector<Interface>& known) {
  if (interface.address.empty()) {
    return refuse("the interface '" + interface.name + "' has no address",
                  "give it one (cable, DHCP), or " + list_of(known), true);
  }
  if (!interface.up) {
    return refuse("the interface '" + interface.name + "' is down", "run ip link set " + interface.name + " up", true);
  }
  return {interface.address, interface.broadcast, {}, {}, interface.name, false};
}

}  // namespace

std::vector<Interface> interfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  std::vector<Interface> out;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const Interface one = interface_of(*entry);
    if (!one.address.empty()) out.push_back(one);
  }
  // An interface is listed once for each family, also without an address: reported only if it has none at all.
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const Interface one = interface_of(*entry);
    if (!has_name(out, one.name)) out.push_back(one);
  }
  std::stable_sort(out.begin(), out.end(), [](const Interface& a, const Interface& b) {
    const auto rank = [](const Interface& one) {
      return std::make_tuple(is_loopback(one.address) || one.address == "::1", one.name, is_v6(one.address),
                             is_link_local(one.address));
    };
    return rank(a) < rank(b);
  });
  return out;
}

bool is_ipv6(const std::string& text) {
  in6_addr address{};
  return inet_pton(AF_INET6, without_scope(text).c_str(), &address) == 1;
}

std::string join_host_port(const std::string& host, std::uint16_t port) {
  return (is_v6(host) ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::string without_scope(const std::string& address) {
  return address.substr(0, address.find('%'));
}

std::string with_scope(const std::string& address, const std::string& interface) {
  const std::size_t start = address.starts_with("[") ? 1 : 0;
  if (!is_link_local(std::string_view(address).substr(start))) return address;
  const std::size_t end = std::min(address.find('%'), address.find(']'));
  const std::size_t rest = std::min(address.find(']'), address.size());
  return address.substr(0, end) + "%" + interface + address.substr(rest);
}

bool is_ipv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

Resolved resolve_interface(const std::string& name_or_address, const std::vector<Interface>& known) {
  if (is_ipv4(name_or_address) && is_loopback(name_or_address)) {
    if (name_or_address == kLoopbackBroadcast || name_or_address == "127.0.0.0") {
      return refuse("'" + name_or_address + "' is no address of one node", "use 127.0.x.y with 1 to 254 for x and y");
    }
    return {name_or_address, kLoopbackBroadcast, {}, {}, "lo", false};
  }
  for (const Interface& interface : known) {
    const bool is_address = interface.address == name_or_address || without_scope(interface.address) == name_or_address;
    if (interface.name == name_or_address || (is_address && !name_or_address.empty())) {
      return found(interface, known);
    }
  }
  return missing_interface(name_or_address, known);
}

}  // namespace trb
