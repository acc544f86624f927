// The node's own bus over TCP, for a container for each service: one socket for all, on which the key proves who comes;
// the tap beside it. What has shown no key of this node is pending, as at the inbox.
#include "common/base/hex.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

/// A node's services and probes are few, and on one machine they all come from one address.
PendingConnectionLimits bus_limits() {
  PendingConnectionLimits limits;
  limits.open = 64;
  limits.open_from_one = 48;
  return limits;
}

}  // namespace

Status RouterShell::open_tcp_bus() {
  const TcpBus& options = options_.bus;
  auto socket = Socket::bus_server(context_, "", &options.keys);
  if (!socket) return socket.error();
  auto tap = Socket::tap_server(context_, "", &options.keys);
  if (!tap) return tap.error();
  bus_door_ = std::make_unique<InboxGuard>(
      loop_, bus_limits(),
      [this](const std::string& source) {
        core_.counters().count("refused.bus_source_blocked");
        log_limited(limit_, read_clocks().mono, Level::warning, "bus_source_blocked",
                    source + " has too many connections to the bus that prove nothing; dropped for 10 s");
      },
      [this](const std::string& address) {
        core_.counters().count("cut.no_service");
        log_limited(limit_, read_clocks().mono, Level::warning, "no_service",
                    "the connection of " + address + " to the bus has become no service in time and was cut");
      });
  auto& bus = buses_["tcp"] = std::make_unique<BusSocket>(BusSocket{std::move(*socket), "", {}});
  tap_ = std::make_unique<Socket>(std::move(*tap));
  // Watched before they are bound: each connection, and the listening sockets themselves, must be seen.
  for (Socket* one : {&bus->socket, tap_.get()}) {
    const bool proves = one == tap_.get();
    bus_monitors_.push_back(std::make_unique<SocketMonitor>(
        context_, loop_, *one, [this, proves](LinkEvent event, int fd) { on_bus_event(event, fd, proves); }));
  }
  loop_.add_socket(
      bus->socket.handle(), [this, at = bus.get()] { drain_bus(*at); }, bus->socket.unseen());
  loop_.add_socket(
      tap_->handle(), [this] { drain_tap(); }, tap_->unseen());
  if (Status bound = bus->socket.bind(options.endpoint); !bound) return bound;
  if (Status bound = tap_->bind(options.tap); !bound) return bound;
  log_event(Level::info, "bus", options.endpoint + ", " + std::to_string(options.names.size()) + " keys");
  return Done{};
}

bool RouterShell::admit_to_bus(BytesView key) {
  if (options_.bus.names.count(key) != 0) return true;
  core_.counters().count("refused.bus_key");
  log_limited(limit_, read_clocks().mono, Level::warning, "bus_key",
              "the key " + to_hex(key) + " is of no service of this node, nor of trb: see keys/bus");
  return false;
}

std::string RouterShell::whom_it_proves(const BusSocket& bus, const Frame& frame) const {
  if (!bus.name.empty()) return bus.name;
  const auto key = from_hex(user_id(frame));
  const auto at = key ? options_.bus.names.find(*key) : options_.bus.names.end();
  return at == options_.bus.names.end() ? "" : at->second;
}

void RouterShell::note_pending_on_bus(const BusSocket& bus, const Frame& frame, ConnectionId from) {
  if (!bus.name.empty()) return;
  const int fd = connection_fd(frame);
  bus_monitors_.front()->catch_up();  // the descriptor may have been another connection's a moment ago
  const PendingConnectionId pending = bus_door_->pending(fd);
  if (core_.bus().knows(from)) return bus_door_->linked(pending);
  bus_door_->leave(pending);  // refused; it reads why first
}

/// `proves`: on this socket the handshake is all there is to prove.
void RouterShell::on_bus_event(LinkEvent event, int fd, bool proves) {
  const PendingConnectionId pending = bus_door_->pending(fd);
  bus_door_->on_event(event, fd);
  const auto refused = [this](const char* name, const char* text) {
    core_.counters().count("refused." + std::string(name));
    log_limited(limit_, read_clocks().mono, Level::warning, name, text);
  };
  switch (event) {
    case LinkEvent::connected:
      if (proves) bus_door_->linked(pending);
      break;
    case LinkEvent::accept_failed:
      core_.counters().count("refused.no_descriptor");
      break;
    case LinkEvent::no_curve:
      return refused("bus_no_curve", "a client without CURVE was refused on the bus");
    case LinkEvent::wrong_server_key:
      return refused("bus_wrong_server_key", "a client came to the bus with a wrong key of the router");
    case LinkEvent::protocol_error:
    case LinkEvent::failed:
      return refused("bus_no_zmtp", "a client of the bus that does not speak ZMTP, or left during the handshake");
    case LinkEvent::refused_key:  // admit_to_bus() has told it
    case LinkEvent::listening:
    case LinkEvent::accepted:
    case LinkEvent::disconnected:
      break;
  }
}

}  // namespace trb::router
