#include "services/router/io/bus_sockets.hpp"

#include "common/base/files.hpp"
#include "common/transport/socket.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/turn_budget.hpp"

namespace trb::router {
namespace {

/// What a lossy frame costs of the turn: a flood of them ends it after eight.
constexpr std::uint64_t kLossyCounts = 32;
/// A connection is asked for its hello once in this time: a burst of a service that does not know yet that its router
/// was started anew wants one answer.
constexpr Duration kAskAgain = std::chrono::milliseconds(100);
constexpr std::size_t kMostAsked = 256;  ///< that are remembered

}  // namespace

BusSockets::BusSockets(ShellContext& shell, Tap& tap, FrameForwarder& forwarder, SentCounter& sent, TcpBus tcp)
    : shell_(shell), tap_(tap), forwarder_(forwarder), sent_(sent), tcp_(std::move(tcp)) {}

Status BusSockets::open() {
  return tcp_.endpoint.empty() ? open_folder() : open_tcp();
}

Status BusSockets::open_folder() {
  if (Status made = make_private_dir("bus"); !made) return made;
  std::vector<std::string> names = shell_.core().config().services;
  names.emplace_back(kProbe);
  for (const std::string& name : names) {
    if (name == "router") continue;
    auto socket = Socket::bus_server(shell_.zmq(), "ipc://bus/" + name + ".ipc");
    if (!socket) return socket.error();
    add_server(name, std::move(*socket), name);
  }
  return tap_.open("ipc://bus/tap.ipc");
}

Status BusSockets::open_tcp() {
  auto socket = Socket::bus_server(shell_.zmq(), "", &tcp_.keys);
  if (!socket) return socket.error();
  if (Status opened = tap_.open("", &tcp_.keys); !opened) return opened;
  guard_ = std::make_unique<TcpBusGuard>(shell_, tcp_.names);
  add_server("tcp", std::move(*socket), "");
  Socket& bus = servers_.at("tcp")->socket;
  if (Status watched = guard_->watch(bus, tap_.socket()); !watched) return watched;
  tap_.set_on_listener([this](int fd) { guard_->on_tap_listener(fd); });
  if (Status bound = bus.bind(tcp_.endpoint); !bound) return bound;
  if (Status bound = tap_.socket().bind(tcp_.tap); !bound) return bound;
  log_event(Level::info, "bus", tcp_.endpoint + ", " + std::to_string(tcp_.names.size()) + " keys");
  return Done{};
}

void BusSockets::add_server(const std::string& key, Socket socket, const std::string& name) {
  auto& server = servers_[key] = std::make_unique<Server>(Server{std::move(socket), name, {}, {}});
  shell_.loop().add_socket(
      server->socket.handle(), [this, at = server.get()] { drain(*at); }, server->socket.unseen());
}

void BusSockets::drain(Server& server) {
  Frame routing_id;
  Frame frame;
  TurnBudget turn(shell_);
  while (turn.has_left()) {
    if (!server.socket.receive(routing_id)) {
      if (guard_ != nullptr) guard_->on_empty();
      return;
    }
    turn.take_message();
    if (!routing_id.more() || !server.socket.receive(frame)) continue;
    turn.take_bytes(frame.size());
    if (frame.more()) {
      add_bytes(0, frame, server.socket.skip_rest(frame));
      shell_.count("refused.malformed");
      continue;
    }
    on_frame(server, view_of(routing_id), frame);
  }
  if (guard_ != nullptr) guard_->on_turn(turn.messages());
}

void BusSockets::look(const LookPart& part) {
  if (guard_ != nullptr && guard_->look(part)) drain(*servers_.at("tcp"));
}

/// Of a bus over TCP, whatever becomes of the frame. `from` 0: a connection that is not known by its routing id.
void BusSockets::add_bytes(ConnectionId from, const Frame& frame, std::uint64_t more) {
  if (guard_ == nullptr) return;
  const auto at = connections_.find(from);
  const auto incomplete = at == connections_.end() ? guard_->incomplete_of(frame) : at->second.incomplete;
  incomplete->add(frame.size());
  incomplete->add_on_wire(more);
}

void BusSockets::on_frame(Server& server, BytesView routing_id, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  const std::string name = whom_it_proves(server, frame);
  if (!header || name.empty()) {
    add_bytes(0, frame);
    shell_.count(header ? "refused.bus_key" : "refused." + std::string(errc_name(header.error().code)));
    return;
  }
  ConnectionId from = connection_of(server, routing_id, name);
  if (header->subtype == ServiceHello::kSubtype) {
    if (from == 0) from = add_connection(server, routing_id, name);
    if (guard_ != nullptr) connections_.at(from).incomplete = guard_->incomplete_of(frame);
    add_bytes(from, frame);
    return on_hello_frame(server, from, name, *header, frame);
  }
  add_bytes(from, frame);
  if (!shell_.core().bus().knows(from)) return request_hello(server, routing_id);
  sent_.count(header->subtype);
  if (is_lossy(*header)) shell_.spend(kLossyCounts - 1);
  forwarder_.from_bus(from, *header, frame);
}

std::string BusSockets::whom_it_proves(const Server& server, const Frame& frame) const {
  return server.name.empty() ? guard_->name_of(frame) : server.name;
}

ConnectionId BusSockets::connection_of(const Server& server, BytesView routing_id, const std::string& name) {
  const auto at = server.connections.find(routing_id);
  if (at == server.connections.end()) return 0;
  const ConnectionId connection = at->second;
  if (connections_.at(connection).name == name) return connection;
  // No two live connections have the same routing id: the previous holder is gone.
  Effects effects;
  forget_connection(connection, effects);
  shell_.carry_out(effects);
  return 0;
}

ConnectionId BusSockets::add_connection(Server& server, BytesView routing_id, const std::string& name) {
  const ConnectionId id = ++next_connection_;
  server.connections.emplace(Bytes(routing_id), id);
  connections_[id] = {
      &server, Bytes(routing_id), name,
      std::make_unique<SharedQueue>(shell_.new_budget(), ShellContext::kDestinationBytes, WaitingFrames::kMost),
      nullptr};
  return id;
}

void BusSockets::on_hello_frame(Server& server, ConnectionId from, const std::string& name, const HeaderView& header,
                                const Frame& frame) {
  on_hello(server, from, name, header);
  if (server.name.empty()) guard_->on_hello(frame, shell_.core().bus().knows(from));
}

void BusSockets::on_hello(Server& server, ConnectionId from, const std::string& name, const HeaderView& header) {
  auto hello = decode<ServiceHello>(header.data);
  Effects effects;
  if (!hello) {
    effects.count("refused.malformed");
  } else {
    free_dead_holder(*hello, effects);
    if (name == kProbe && shell_.core().bus().is_full()) free_dead_probes(server, from, effects);
    shell_.core().bus().on_hello(from, *hello, name, read_clocks(), effects);
  }
  shell_.carry_out(effects);
  forget_unknown();
}

void BusSockets::forget_unknown() {
  // Connections that were refused just now, and probes that have been silent for long.
  std::vector<ConnectionId> unknown;
  for (const auto& [id, connection] : connections_) {
    if (!shell_.core().bus().knows(id)) unknown.push_back(id);
  }
  Effects effects;
  for (const ConnectionId id : unknown) forget_connection(id, effects);
  shell_.carry_out(effects);
}

void BusSockets::free_dead_holder(const ServiceHello& hello, Effects& effects) {
  const auto holder = shell_.core().bus().services().holder(hello.service);
  if (holder && is_gone(*holder)) forget_connection(*holder, effects);
}

void BusSockets::free_dead_probes(Server& server, ConnectionId requester, Effects& effects) {
  std::vector<ConnectionId> known;
  for (const auto& [routing_id, connection] : server.connections) known.push_back(connection);
  for (const ConnectionId connection : known) {
    const auto at = connections_.find(connection);
    const bool other = at != connections_.end() && at->second.name == kProbe && connection != requester;
    if (other && is_gone(connection)) forget_connection(connection, effects);
  }
}

bool BusSockets::is_gone(ConnectionId connection) {
  // A mandatory send is refused at once if the process at the other end has ended.
  Message ping;
  ping.type = MessageType::information;
  ping.subtype = ServiceAliveSeen::kSubtype;
  ping.data = encode(ServiceAliveSeen{shell_.core().config().instance});
  return send(connection, to_frame(encode_frame(ping))) == SendResult::unroutable;
}

void BusSockets::request_hello(Server& server, BytesView routing_id) {
  const MonotonicTime now = read_clocks().mono;
  const auto before = server.asked.find(routing_id);
  if (before != server.asked.end() && now - before->second < kAskAgain) return;
  std::erase_if(server.asked, [&](const auto& one) { return now - one.second >= kAskAgain; });
  if (server.asked.size() < kMostAsked) server.asked.emplace(routing_id, now);
  Message message;
  message.type = MessageType::information;
  message.subtype = HelloWanted::kSubtype;
  message.source = shell_.core().config().id;
  message.target = shell_.core().config().id;
  message.data = encode(HelloWanted{});
  server.socket.send_to(routing_id, to_frame(encode_frame(message)));
}

void BusSockets::forget_connection(ConnectionId connection, Effects& effects) {
  shell_.core().on_connection_gone(connection, read_clocks(), effects);
  const auto at = connections_.find(connection);
  if (at == connections_.end()) return;
  at->second.server->connections.erase(at->second.routing_id);
  connections_.erase(at);
}

SendResult BusSockets::send_of(std::string_view peer, ConnectionId to, Frame&& frame) {
  const auto at = connections_.find(to);
  if (at == connections_.end()) return SendResult::unroutable;
  const Connection& connection = at->second;
  if (peer == shell_.core().config().id) peer = {};
  if (!peer.empty() && !connection.queue->has_share(peer, frame.size())) {
    shell_.count("dropped.peer_share");
    return SendResult::full;
  }
  const SendResult result = connection.queue->send(peer, frame, [&](Frame&& one) {
    return connection.server->socket.send_to(connection.routing_id, std::move(one));
  });
  if (result == SendResult::unroutable) forget_unroutable(to);
  return result;
}

void BusSockets::forget_unroutable(ConnectionId connection) {
  Effects effects;
  forget_connection(connection, effects);
  shell_.carry_out(effects);
}

}  // namespace trb::router
