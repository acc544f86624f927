// The node's own bus: one ROUTER socket for each service of node.json, one for probes.
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

constexpr int kBatch = 256;
constexpr int kLossyCounts = 32;  ///< for so many: a flood of what may be lost leaves the turn to others after eight

}  // namespace

void RouterShell::drain_bus(BusSocket& bus) {
  Frame routing_id;
  Frame frame;
  std::size_t bytes = 0;
  for (int i = 0; i < kBatch && bytes < kTurnBytes; ++i) {
    if (!bus.socket.receive(routing_id)) return;
    if (!routing_id.more() || !bus.socket.receive(frame)) continue;
    bytes += frame.size();
    if (frame.more()) {
      bus.socket.skip_rest(frame);
      core_.counters().count("refused.malformed");
      continue;
    }
    i += on_bus_frame(bus, view_of(routing_id), frame) - 1;
  }
}

ConnectionId RouterShell::connection_of(const BusSocket& bus, BytesView routing_id) const {
  const auto at = bus.connections.find(routing_id);
  return at == bus.connections.end() ? 0 : at->second;
}

ConnectionId RouterShell::add_connection(BusSocket& bus, BytesView routing_id, const std::string& name) {
  const ConnectionId id = ++next_connection_;
  bus.connections.emplace(Bytes(routing_id), id);
  connections_[id] = {&bus, Bytes(routing_id), name, new_budget()};
  return id;
}

int RouterShell::on_bus_frame(BusSocket& bus, BytesView routing_id, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  const std::string name = whom_it_proves(bus, frame);
  if (!header || name.empty()) {
    core_.counters().count(header ? "refused.bus_key" : "refused." + std::string(errc_name(header.error().code)));
    return 1;
  }
  ConnectionId from = connection_of(bus, routing_id);
  if (from != 0 && connections_.at(from).name != name) {
    // Of those that are there no two have one routing id: the one that had it has gone.
    Effects effects;
    forget_connection(from, effects);
    carry_out(effects);
    from = 0;
  }
  if (header->subtype == ServiceHello::kSubtype) {
    if (from == 0) from = add_connection(bus, routing_id, name);
    on_bus_hello(bus, from, name, *header);
    note_pending_on_bus(bus, frame, from);
    return 1;
  }
  if (!core_.bus().knows(from)) {
    want_hello(bus, routing_id);
    return 1;
  }
  count_sent(header->subtype);
  const bool lossy = is_lossy(*header);
  forward_bus_frame(from, *header, frame);
  return lossy ? kLossyCounts : 1;
}

void RouterShell::forward_bus_frame(ConnectionId from, const HeaderView& header, Frame& frame) {
  Effects effects;
  const FrameOrders orders =
      core_.forwarding().from_bus(from, header, static_cast<char*>(frame.data()), frame.size(), read_clocks(), effects);
  const char direction = orders.way.to == Routing::To::service ? '=' : '>';
  for (unsigned i = 0; i < orders.shown; ++i) tap(direction, view_of(frame));
  for (const ConnectionId to : orders.copies) {
    if (send_bus(to, to_frame(view_of(frame))) != SendResult::sent) core_.counters().count("dropped.queue_full");
  }
  send_forwarded(from, header, orders, frame, effects);
  if (!effects.list.empty() || !effects.counts.empty()) carry_out(effects);
  for (const Routing& way : orders.each) send_copy(way, frame);
  if (!orders.each.empty()) end_lost_links();
}

void RouterShell::send_forwarded(ConnectionId from, const HeaderView& header, const FrameOrders& orders, Frame& frame,
                                 Effects& effects) {
  const Routing& way = orders.way;
  if (way.to == Routing::To::lane) return publish(way.link, std::move(frame));
  // A send that failed has left the frame, and the header that points into it, alone.
  if (way.to == Routing::To::service) {
    const SendResult result = send_bus(way.connection, std::move(frame));
    if (result != SendResult::sent) core_.forwarding().on_unsent(from, header, why_undelivered(result), effects);
  } else if (way.to == Routing::To::peer) {
    const SendResult result = put_outgoing(way.link, orders.outgoing, std::move(frame));
    if (result != SendResult::sent) core_.forwarding().on_unsent(from, header, why_unsent(result), effects);
    if (result == SendResult::unroutable) lost_links_.push_back(way.link);
  }
}

/// Of what goes to every peer.
void RouterShell::send_copy(const Routing& way, const Frame& frame) {
  tap('>', view_of(frame));
  if (way.to == Routing::To::lane) return publish(way.link, to_frame(view_of(frame)));
  const SendResult result = send_link(way.link, to_frame(view_of(frame)));
  if (result == SendResult::unroutable) lost_links_.push_back(way.link);
  if (result != SendResult::sent) core_.counters().count("dropped." + std::string(errc_name(why_unsent(result))));
}

void RouterShell::on_bus_hello(BusSocket& bus, ConnectionId from, const std::string& name, const HeaderView& header) {
  auto hello = decode<ServiceHello>(header.data);
  Effects effects;
  if (!hello) {
    effects.count("refused.malformed");
  } else {
    free_dead_holder(*hello, effects);
    if (name == kProbe && core_.bus().is_full()) free_dead_probes(bus, from, effects);
    core_.bus().on_hello(from, *hello, name, read_clocks(), effects);
  }
  carry_out(effects);
  forget_unknown();
}

void RouterShell::forget_unknown() {
  // Those that were refused just now, and probes that have been silent for long.
  std::vector<ConnectionId> unknown;
  for (const auto& [id, connection] : connections_) {
    if (!core_.bus().knows(id)) unknown.push_back(id);
  }
  Effects effects;
  for (const ConnectionId id : unknown) forget_connection(id, effects);
  carry_out(effects);
}

void RouterShell::free_dead_holder(const ServiceHello& hello, Effects& effects) {
  const auto holder = core_.bus().services().holder(hello.service);
  if (holder && is_gone(*holder)) forget_connection(*holder, effects);
}

void RouterShell::free_dead_probes(BusSocket& bus, ConnectionId asker, Effects& effects) {
  std::vector<ConnectionId> known;
  for (const auto& [routing_id, connection] : bus.connections) known.push_back(connection);
  for (const ConnectionId connection : known) {
    const auto at = connections_.find(connection);
    const bool other = at != connections_.end() && at->second.name == kProbe && connection != asker;
    if (other && is_gone(connection)) forget_connection(connection, effects);
  }
}

bool RouterShell::is_gone(ConnectionId connection) {
  // A mandatory send is refused at once if the process at the other end has ended.
  Message ping;
  ping.type = MessageType::information;
  ping.subtype = ServiceAliveSeen::kSubtype;
  ping.data = encode(ServiceAliveSeen{core_.config().instance});
  return send_bus(connection, to_frame(encode_frame(ping))) == SendResult::unroutable;
}

void RouterShell::want_hello(BusSocket& bus, BytesView routing_id) {
  Message message;
  message.type = MessageType::information;
  message.subtype = HelloWanted::kSubtype;
  message.source = core_.config().id;
  message.target = core_.config().id;
  message.data = encode(HelloWanted{});
  bus.socket.send_to(routing_id, to_frame(encode_frame(message)));
}

void RouterShell::forget_connection(ConnectionId connection, Effects& effects) {
  core_.on_connection_gone(connection, read_clocks(), effects);
  const auto at = connections_.find(connection);
  if (at == connections_.end()) return;
  at->second.socket->connections.erase(at->second.routing_id);
  connections_.erase(at);
}

SendResult RouterShell::send_bus(ConnectionId to, Frame&& frame) {
  const auto at = connections_.find(to);
  if (at == connections_.end()) return SendResult::unroutable;
  const BusConnection& connection = at->second;
  const SendResult result = send_within(connection.budget, frame, [&](Frame&& one) {
    return connection.socket->socket.send_to(connection.routing_id, std::move(one));
  });
  if (result == SendResult::unroutable) {
    Effects effects;
    forget_connection(to, effects);
    carry_out(effects);
  }
  return result;
}

}  // namespace trb::router
