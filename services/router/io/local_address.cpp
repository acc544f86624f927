#include "services/router/io/local_address.hpp"

namespace trb::router {
namespace {

constexpr Duration kLookAgain = std::chrono::seconds(2);

}  // namespace

LocalAddress::LocalAddress(ShellContext& shell, InboxSocket& inbox, LaneSockets& lanes, BeaconChannel& beacons,
                           const ShellOptions& options)
    : shell_(shell),
      inbox_(inbox),
      lanes_(lanes),
      beacons_(beacons),
      host_int_(options.host_int),
      vpn_int_(options.vpn_int),
      port_(options.port),
      lane_port_(options.lane_port) {}

Status LocalAddress::open() {
  auto watch = InterfaceWatch::open(shell_.loop(), [this] { follow_interfaces(); });
  if (watch) {
    watch_ = std::move(*watch);
  } else {
    log_event(Level::warning, "no_interface_watch", watch.error().text());
  }
  shell_.loop().add_timer([this] { return look_again_; }, [this](Now) { follow_interfaces(); });
  const std::vector<Interface> there = interfaces();
  const Resolved host = resolve_interface(host_int_, there);
  wait_text_ = host.what.empty() ? "" : "HOST_INT: " + host.what;
  if (Status bound = bind(host); !bound) {
    // A fresh IPv6 address cannot be used until the kernel has checked that no other host has it (DAD).
    if (!is_ipv6(host.address)) return bound;
    wait_text_ = bound.error().text();
    look_again_ = read_clocks().mono + kLookAgain;
  }
  if (!wait_text_.empty()) log_event(Level::warning, "waiting", wait_text_ + "; " + host.hint);
  follow_vpn(there);
  return Done{};
}

/// Binds this address, which may be none yet; every connection to the old one ends.
Status LocalAddress::bind(const Resolved& host) {
  beacons_.close();
  vpn_endpoint_.clear();
  host_ = {};
  const std::string endpoint = host.address.empty() ? "" : "tcp://" + join_host_port(host.address, port_);
  if (Status opened = inbox_.open(endpoint); !opened) return opened;
  if (Status opened = beacons_.open(host); !opened) return opened;
  host_ = host;
  open_lane();
  return Done{};
}

void LocalAddress::open_lane() {
  if (host_.address.empty()) return lanes_.own().close();
  const Status opened = lanes_.own().open(host_.address, lane_port_);
  if (opened) return;
  shell_.log(Level::warning, "no_lane", opened.error().text());
  look_again_in(kLookAgain);
}

void LocalAddress::follow_interfaces() {
  look_again_.reset();
  const std::vector<Interface> there = interfaces();
  // Every machine has a loopback: the list could not be read, for lack of a descriptor. No address is known to be gone.
  if (there.empty()) return look_again_in(kLookAgain);
  const Resolved host = look_up(there);
  if (host.address != host_.address || host.broadcast != host_.broadcast) {
    move_to(host);
  } else if (lanes_.own().port() == 0) {
    open_lane();
  }
  wait_text_ = host_.address.empty() ? "HOST_INT: " + (host.what.empty() ? "cannot be bound yet" : host.what) : "";
  notify();
  follow_vpn(there);
}

/// The current address of HOST_INT.
Resolved LocalAddress::look_up(const std::vector<Interface>& there) {
  Resolved host = resolve_interface(host_int_, there);
  if (link_local_.takes(host.address, host_.address, host_int_, read_clocks().mono)) return host;
  look_again_ = link_local_.until();
  return {{}, {}, "the interface '" + host_int_ + "' has a link-local address only", "", {}, true};
}

void LocalAddress::move_to(const Resolved& host) {
  log_event(Level::warning, "address_changed",
            "from " + (host_.address.empty() ? "none" : host_.address) + " to " +
                (host.address.empty() ? "none: " + host.what : host.address));
  // End the links first: their sockets close with the inbox.
  Effects effects;
  shell_.core().set_address("", host.what, read_clocks(), effects);
  shell_.carry_out(effects);
  if (Status bound = bind(host); !bound) {
    log_event(Level::warning, "cannot_bind", bound.error().text());
    look_again_ = read_clocks().mono + kLookAgain;
  }
}

void LocalAddress::notify() {
  Effects effects;
  shell_.core().set_lane(own_lane());
  shell_.core().set_address(own_address(), wait_text_, read_clocks(), effects);
  shell_.carry_out(effects);
}

std::string LocalAddress::own_address() const {
  return host_.address.empty() ? "" : join_host_port(without_scope(host_.address), port_);
}

std::string LocalAddress::own_lane() const {
  const std::uint16_t port = lanes_.own().port();
  return host_.address.empty() || port == 0 ? "" : join_host_port(without_scope(host_.address), port);
}

/// The VPN's address is a second address of the inbox: peers that name it as a seed connect there.
void LocalAddress::follow_vpn(const std::vector<Interface>& there) {
  if (vpn_int_.empty() || vpn_int_ == host_int_) return;
  if (!inbox_.is_open()) return;  // there was no descriptor for one: it is tried again
  const Resolved vpn = resolve_interface(vpn_int_, there);
  const bool other = !vpn.address.empty() && vpn.address != host_.address;
  lanes_.own().also_at(other ? vpn.address : "");
  const std::string endpoint = other ? "tcp://" + join_host_port(vpn.address, port_) : "";
  if (endpoint != vpn_endpoint_) move_vpn_to(endpoint);
}

void LocalAddress::move_vpn_to(const std::string& endpoint) {
  if (!vpn_endpoint_.empty()) {
    inbox_.unbind(vpn_endpoint_);
    log_event(Level::warning, "vpn_gone", vpn_endpoint_);
  }
  vpn_endpoint_.clear();
  if (endpoint.empty()) return;
  if (Status bound = inbox_.bind(endpoint); !bound) {
    log_event(Level::warning, "cannot_bind", bound.error().text());
    return look_again_in(kLookAgain);
  }
  vpn_endpoint_ = endpoint;
  log_event(Level::info, "vpn_here", endpoint);
}

void LocalAddress::look_again_in(Duration wait) {
  look_again_ = earlier(look_again_, read_clocks().mono + wait);
}

}  // namespace trb::router
