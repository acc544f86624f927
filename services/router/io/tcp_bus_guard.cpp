#include "services/router/io/tcp_bus_guard.hpp"

#include "common/base/hex.hpp"

namespace trb::router {
namespace {

/// Heartbeats both ways every 2 s, 42 bytes each; see Socket::bus_server().
constexpr std::uint64_t kHeartbeats = 64;

/// A node has few services and probes, and on one machine they all come from one address.
PendingConnectionLimits bus_limits() {
  PendingConnectionLimits limits;
  limits.open = 64;
  limits.open_from_one = 48;
  return limits;
}

}  // namespace

TcpBusGuard::TcpBusGuard(ShellContext& shell, std::map<Bytes, std::string, std::less<>> names)
    : shell_(shell),
      names_(std::move(names)),
      guard_(
          shell.loop(), bus_limits(),
          [this](const std::string& source) {
            shell_.count("refused.bus_source_blocked");
            shell_.log(Level::warning, "bus_source_blocked",
                       source + " has too many connections to the bus that prove nothing; dropped for 10 s");
          },
          [this](const std::string& address) {
            shell_.count("cut.no_service");
            shell_.log(Level::warning, "no_service",
                       "the connection of " + address + " to the bus has become no service in time and was cut");
          }) {
  // After a restart of the router a service may go on before it is asked for its Hello.
  guard_.all_carry();
  guard_.set_on_incomplete([this](PendingConnectionId, const std::string& address) {
    shell_.count("cut.incomplete");
    shell_.log(Level::warning, "incomplete",
               "the connection of " + address + " to the bus sent parts of a message without end, and was cut");
  });
}

Status TcpBusGuard::watch(Socket& bus, Socket& tap) {
  if (Status watched = watch(bus); !watched) return watched;
  return watch(tap);
}

Status TcpBusGuard::watch(Socket& socket) {
  auto monitor = SocketMonitor::watch(shell_.zmq(), shell_.loop(), socket,
                                      [this](LinkEvent event, int fd) { on_event(event, fd); });
  if (!monitor) return monitor.error();
  monitors_.push_back(std::move(*monitor));
  return Done{};
}

bool TcpBusGuard::admit(BytesView key) {
  if (names_.count(key) != 0) return true;
  shell_.count("refused.bus_key");
  shell_.log(Level::warning, "bus_key",
             "the key " + to_hex(key) + " is of no service of this node, nor of trb: see keys/bus");
  return false;
}

std::string TcpBusGuard::name_of(const Frame& frame) const {
  const auto key = from_hex(user_id(frame));
  const auto at = key ? names_.find(*key) : names_.end();
  return at == names_.end() ? "" : at->second;
}

void TcpBusGuard::on_hello(const Frame& frame, bool accepted) {
  const PendingConnectionId pending = pending_of(frame);
  if (accepted) return guard_.linked(pending);
  guard_.leave(pending);  // refused; it reads the reason first
}

void TcpBusGuard::on_tap_listener(int fd) {
  monitors_.back()->catch_up();
  guard_.linked(guard_.pending(fd));
}

PendingConnectionId TcpBusGuard::pending_of(const Frame& frame) {
  monitors_.front()->catch_up();  // another connection may have had this descriptor a moment ago
  return guard_.pending(connection_fd(frame));
}

std::shared_ptr<IncompleteBytes> TcpBusGuard::incomplete_of(const Frame& frame) {
  return guard_.carries(pending_of(frame));
}

bool TcpBusGuard::look(const LookPart& part) {
  for (const auto& monitor : monitors_) monitor->catch_up();
  return guard_.look(kHeartbeats, part);
}

void TcpBusGuard::on_event(LinkEvent event, int fd) {
  guard_.on_event(event, fd);
  switch (event) {
    case LinkEvent::accept_failed:
      return shell_.count("refused.no_descriptor");
    case LinkEvent::no_curve:
      return refused("bus_no_curve", "a client without CURVE was refused on the bus");
    case LinkEvent::wrong_server_key:
      return refused("bus_wrong_server_key", "a client came to the bus with a wrong key of the router");
    case LinkEvent::protocol_error:
    case LinkEvent::failed:
      return refused("bus_no_zmtp", "a client of the bus that does not speak ZMTP, or left during the handshake");
    default:  // admit() has reported a refused key
      return;
  }
}

void TcpBusGuard::refused(const char* name, const char* text) {
  shell_.count("refused." + std::string(name));
  shell_.log(Level::warning, name, text);
}

}  // namespace trb::router
