// Where this node is: the inbox and the beacons follow the addresses of HOST_INT and VPN_INT.
#include "common/base/hex.hpp"
#include "common/config/interfaces.hpp"
#include "services/router/io/lane_server.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

constexpr Duration kAgain = std::chrono::seconds(2);
/// While a lease is renewed, an interface has its link-local address alone: nobody moves there for so short a time.
constexpr Duration kLinkLocalOnly = std::chrono::seconds(3);

bool is_link_local(const std::string& address) {
  return address.starts_with("fe80:");
}

}  // namespace

Status RouterShell::open_local_address() {
  auto watch = InterfaceWatch::open(loop_, [this] { follow_interfaces(); });
  if (watch) {
    interface_watch_ = std::move(*watch);
  } else {
    log_event(Level::warning, "no_interface_watch", watch.error().text());
  }
  loop_.add_timer([this] { return look_again_; }, [this](Now) { follow_interfaces(); });
  const Resolved host = resolve_interface(options_.host_int, interfaces());
  wait_text_ = host.what.empty() ? "" : "HOST_INT: " + host.what;
  if (Status opened = open_inbox(host); !opened) {
    // A fresh IPv6 address is of no use until the kernel has asked whether another host has it.
    if (!is_ipv6(host.address)) return opened;
    wait_text_ = opened.error().text();
    look_again_ = read_clocks().mono + kAgain;
  }
  if (!wait_text_.empty()) log_event(Level::warning, "waiting", wait_text_ + "; " + host.hint);
  follow_vpn();
  return Done{};
}

/// An inbox at this address, which may be none yet; the old one and every connection to it is gone.
Status RouterShell::open_inbox(const Resolved& host) {
  if (inbox_) loop_.remove_socket(inbox_->handle());
  inbox_monitor_.reset();
  inbox_.reset();
  inbox_guard_.reset();
  beacon_.reset();
  vpn_endpoint_.clear();
  host_ = {};
  const std::string endpoint = host.address.empty() ? "" : "tcp://" + join_host_port(host.address, options_.port);
  auto inbox = Socket::inbox(context_, "", options_.link_keys);
  if (!inbox) return inbox.error();
  inbox_ = std::make_unique<Socket>(std::move(*inbox));
  inbox_monitor_ = std::make_unique<SocketMonitor>(context_, loop_, *inbox_,
                                                   [this](LinkEvent event, int fd) { on_inbox_event(event, fd); });
  loop_.add_socket(
      inbox_->handle(), [this] { drain_inbox(); }, inbox_->unseen());
  // The monitor is there before the port opens: it must see every connection, and the listening socket itself.
  const Status bound = endpoint.empty() ? Status(Done{}) : inbox_->bind(endpoint);
  if (!bound) return bound;
  if (!host.address.empty() && core_.config().beacon && !host.broadcast.empty()) {
    auto beacon = BeaconSocket::open(loop_, host.address, host.broadcast, options_.beacon_port,
                                     [this](BytesView datagram) { on_beacon_datagram(datagram); });
    if (!beacon) return beacon.error();
    beacon_ = std::move(*beacon);
  }
  host_ = host;
  open_lane();
  return Done{};
}

void RouterShell::follow_interfaces() {
  look_again_.reset();
  const MonotonicTime now = read_clocks().mono;
  Resolved host = resolve_interface(options_.host_int, interfaces());
  const bool fallen_back =
      is_link_local(host.address) && !is_link_local(host_.address) && host.address != options_.host_int;
  if (fallen_back && !(host_.address.empty() && now >= alone_until_)) {
    if (!host_.address.empty()) alone_until_ = now + kLinkLocalOnly;
    look_again_ = alone_until_;
    host = {{}, {}, "the interface '" + options_.host_int + "' has a link-local address only", "", {}, true};
  }
  if (host.address != host_.address || host.broadcast != host_.broadcast) {
    move_to(host);
  } else if (lane_->port() == 0) {
    open_lane();
  }
  wait_text_ = host_.address.empty() ? "HOST_INT: " + (host.what.empty() ? "cannot be bound yet" : host.what) : "";
  notify_local_address();
  follow_vpn();
}

void RouterShell::move_to(const Resolved& host) {
  log_event(Level::warning, "address_changed",
            "from " + (host_.address.empty() ? "none" : host_.address) + " to " +
                (host.address.empty() ? "none: " + host.what : host.address));
  // The links end first: their sockets go with the inbox.
  Effects effects;
  core_.set_address("", host.what, read_clocks(), effects);
  carry_out(effects);
  accepted_.clear();
  if (Status opened = open_inbox(host); !opened) {
    log_event(Level::warning, "cannot_bind", opened.error().text());
    look_again_ = read_clocks().mono + kAgain;
  }
}

void RouterShell::notify_local_address() {
  Effects effects;
  core_.set_lane(own_lane());
  core_.set_address(own_address(), wait_text_, read_clocks(), effects);
  carry_out(effects);
}

std::string RouterShell::own_address() const {
  return host_.address.empty() ? "" : join_host_port(without_scope(host_.address), options_.port);
}

/// The VPN's address is a second way in: peers that name it as a seed come in by it.
void RouterShell::follow_vpn() {
  if (options_.vpn_int.empty() || options_.vpn_int == options_.host_int) return;
  if (!inbox_) return;  // there was no descriptor for one: it is tried again
  const Resolved vpn = resolve_interface(options_.vpn_int, interfaces());
  const bool other = !vpn.address.empty() && vpn.address != host_.address;
  const std::string endpoint = other ? "tcp://" + join_host_port(vpn.address, options_.port) : "";
  lane_->also_at(other ? vpn.address : "");
  if (endpoint == vpn_endpoint_) return;
  if (!vpn_endpoint_.empty()) {
    inbox_->unbind(vpn_endpoint_);
    log_event(Level::warning, "vpn_gone", vpn_endpoint_);
  }
  vpn_endpoint_.clear();
  if (endpoint.empty()) return;
  if (Status bound = inbox_->bind(endpoint); !bound) {
    log_event(Level::warning, "cannot_bind", bound.error().text());
    look_again_ = earlier(look_again_, read_clocks().mono + kAgain);
    return;
  }
  vpn_endpoint_ = endpoint;
  log_event(Level::info, "vpn_here", endpoint);
}

/// A link-local address that another machine told bears no scope, or its own: here it is reached by HOST_INT.
std::string RouterShell::to_dial(const std::string& address) const {
  return with_scope(address, host_.interface);
}

}  // namespace trb::router
