// Links to other routers: the inbox (accepted) and a DEALER for each dialled one.
#include <algorithm>

#include "common/base/address.hpp"
#include "common/base/hex.hpp"
#include "services/router/io/lane_server.hpp"
#include "services/router/io/proof_log.hpp"
#include "services/router/io/resolver.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

constexpr int kBatch = 256;

}  // namespace

std::optional<LinkEnd> to_end(LinkEvent event) {
  switch (event) {
    case LinkEvent::connected:
    case LinkEvent::listening:
    case LinkEvent::accepted:
    case LinkEvent::accept_failed:
      return std::nullopt;
    case LinkEvent::failed:
      return LinkEnd::failed;
    case LinkEvent::disconnected:
      return LinkEnd::disconnected;
    case LinkEvent::refused_key:
      return LinkEnd::refused_key;
    case LinkEvent::no_curve:
      return LinkEnd::no_curve;
    case LinkEvent::wrong_server_key:
      return LinkEnd::wrong_server_key;
    case LinkEvent::protocol_error:
      return LinkEnd::protocol_error;
  }
  return LinkEnd::failed;
}

void RouterShell::drain_inbox() {
  Frame routing_id;
  Frame frame;
  std::size_t bytes = 0;
  for (int i = 0; i < kBatch && bytes < kTurnBytes; ++i) {
    if (!inbox_->receive(routing_id)) return;
    if (!routing_id.more() || !inbox_->receive(frame)) continue;
    bytes += frame.size();
    if (frame.more()) {
      inbox_->skip_rest(frame);
      core_.counters().count("refused.malformed");
      continue;
    }
    on_inbox_frame(view_of(routing_id), frame);
  }
}

PendingConnectionId RouterShell::pending_at_inbox(const Frame& frame) {
  inbox_monitor_->catch_up();  // the descriptor may have been another connection's a moment ago
  return inbox_guard_.pending(connection_fd(frame));
}

void RouterShell::on_inbox_frame(BytesView routing_id, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  const bool other_version = !header && header.error().code == Errc::version_mismatch;
  if (other_version && pending_at_inbox(frame) != 0 && inbox_guard_.is_undecided(connection_fd(frame)))
    return on_other_version(routing_id, frame);
  if (!header) {
    const auto from = std::find_if(accepted_.begin(), accepted_.end(), [&](const auto& row) {
      return row.second.routing_id == routing_id && row.second.user == user_id(frame);
    });
    if (from == accepted_.end()) inbox_guard_.leave(pending_at_inbox(frame));
    return on_bad_frame(from == accepted_.end() ? 0 : from->first, header.error());
  }
  const std::string_view user = user_id(frame);
  const auto link = accepted_.find(header->link);
  const bool proven = link != accepted_.end() && link->second.routing_id == routing_id && link->second.user == user;
  if (proven) return on_link_frame(header->link, *header, frame);
  const auto key = from_hex(user);
  if (!key || key->size() != 32) return core_.counters().count("refused.no_key");
  origin_ = {Bytes(routing_id), Bytes(user), pending_at_inbox(frame)};
  Effects effects;
  if (link != accepted_.end()) {
    // Another connection names a link that is not its own.
    effects.count("refused.link_theft");
    effects.log(LogLevel::warning, "link_theft", "a connection used another one's link id");
  } else if (!inbox_guard_.is_undecided(connection_fd(frame))) {
    const auto own = std::find_if(accepted_.begin(), accepted_.end(),
                                  [&](const auto& row) { return row.second.pending == origin_.pending; });
    if (own == accepted_.end()) {
      effects.count("dropped.closed_link");
    } else {
      core_.links().on_second_link(own->first, read_clocks(), effects);
    }
  } else {
    const Now now = read_clocks();
    const FrameOrders orders = core_.forwarding().from_stranger(*key, *header, view_of(frame), now, effects);
    keep_proof(orders, now.utc, view_of(frame));
  }
  carry_out(effects);
  origin_ = {};
}

/// The first word of a connection, in another version of the wire.
void RouterShell::on_other_version(BytesView routing_id, Frame& frame) {
  const auto header = decode_frame_of_any_version(view_of(frame));
  const auto key = from_hex(user_id(frame));
  const PendingConnectionId pending = pending_at_inbox(frame);
  if (!header || !key || key->size() != 32) {
    inbox_guard_.leave(pending);
    return on_bad_frame(0,
                        fail(Errc::version_mismatch, "wire version " + std::to_string(wire_version(view_of(frame)))));
  }
  origin_ = {Bytes(routing_id), Bytes(user_id(frame)), pending};
  Effects effects;
  core_.handshake().on_other_version(0, *key, wire_version(view_of(frame)), *header, read_clocks(), effects);
  carry_out(effects);
  origin_ = {};
}

void RouterShell::on_link_frame(LinkId link, const HeaderView& header, Frame& frame) {
  Effects effects;
  const Now now = read_clocks();
  const FrameOrders orders = core_.forwarding().from_link(link, header, view_of(frame), now, effects);
  keep_proof(orders, now.utc, view_of(frame));
  deliver_frame(link, header, frame, orders, effects);
  if (!effects.list.empty() || !effects.counts.empty()) carry_out(effects);
}

void RouterShell::deliver_frame(LinkId link, const HeaderView& header, Frame& frame, const FrameOrders& orders,
                                Effects& effects) {
  for (const ConnectionId to : orders.copies) {
    const SendResult result = deliver(link, header.sequence, orders.hold, to, to_frame(view_of(frame)));
    if (result != SendResult::sent) core_.counters().count("dropped.queue_full");
  }
  if (orders.shown > 0) tap('<', view_of(frame));
  if (orders.way.to != Routing::To::service) return;
  const SendResult result = deliver(link, header.sequence, orders.hold, orders.way.connection, std::move(frame));
  // A send that failed has left the frame, and the header that points into it, alone.
  if (result != SendResult::sent) core_.forwarding().on_undelivered(link, header, why_undelivered(result), effects);
}

void RouterShell::drain_dialled(LinkId link) {
  Frame frame;
  std::size_t bytes = 0;
  for (int i = 0; i < kBatch && bytes < kTurnBytes; ++i) {
    const auto at = dialled_.find(link);
    if (at == dialled_.end() || !at->second.socket->receive(frame)) return;
    bytes += frame.size();
    if (frame.more()) {
      at->second.socket->skip_rest(frame);
      core_.counters().count("refused.malformed");
      continue;
    }
    const auto header = decode_frame(view_of(frame));
    if (!header) {
      on_undecoded(link, frame, header.error());
    } else if (header->link != link) {
      core_.counters().count("refused.malformed");
    } else {
      on_link_frame(link, *header, frame);
    }
  }
}

/// A frame of a dialled link that cannot be decoded, perhaps for it is of another version of the wire.
void RouterShell::on_undecoded(LinkId link, const Frame& frame, const Error& error) {
  const auto other = decode_frame_of_any_version(view_of(frame));
  const Link* known = core_.table().link(link);
  const bool answers_hello = known != nullptr && !known->up;
  if (error.code != Errc::version_mismatch || !other || !answers_hello) return on_bad_frame(link, error);
  Effects effects;
  core_.handshake().on_other_version(link, Bytes(known->key), wire_version(view_of(frame)), *other, read_clocks(),
                                     effects);
  carry_out(effects);
}

void RouterShell::dial(const Dial& effect) {
  if (is_numeric_endpoint(effect.address)) return dial_numbers(effect, "");
  const Now now = read_clocks();
  const Resolver::Found found = resolver_->find(effect.address, now.mono);
  if (!found.address.empty()) {
    core_.links().on_name_found(effect.link, found.address);
    return dial_numbers({effect.link, found.address, effect.server_key}, effect.address);
  }
  Effects effects;
  core_.links().on_name_unknown(effect.link, found.trouble, now, effects);
  carry_out(effects);
}

/// libzmq asks the name server on the one thread that carries everything: it gets numbers only.
void RouterShell::dial_numbers(const Dial& effect, const std::string& name) {
  const Status opened = open_dialled(effect, name);
  if (opened) return;
  // No descriptor is left: it ends as a dial that failed, and is tried again.
  core_.counters().count("dial.no_descriptor");
  log_limited(limit_, read_clocks().mono, Level::error, "no_descriptor",
              effect.address + " cannot be dialled: " + opened.error().what + "; raise the limit of open files");
  lost_links_.push_back(effect.link);
}

Status RouterShell::open_dialled(const Dial& effect, const std::string& name) {
  Dialled dialled;
  dialled.name = name;
  dialled.budget = new_budget();
  auto made = Socket::dialler(context_, options_.link_keys, effect.server_key);
  if (!made) return made.error();
  dialled.socket = std::make_unique<Socket>(std::move(*made));
  const LinkId link = effect.link;
  auto monitor = SocketMonitor::watch(context_, loop_, *dialled.socket, [this, link](LinkEvent event, int) {
    Effects effects;
    const auto end = to_end(event);
    if (end) {
      core_.links().on_ended(link, *end, read_clocks(), effects);
    } else {
      core_.handshake().on_dial_connected(link, read_clocks(), effects);
    }
    carry_out(effects);
  });
  if (!monitor) return monitor.error();
  dialled.monitor = std::move(*monitor);
  loop_.add_socket(
      dialled.socket->handle(), [this, link] { drain_dialled(link); }, dialled.socket->unseen());
  Socket* socket = dialled.socket.get();
  dialled_[link] = std::move(dialled);
  if (const Status sent = socket->dial("tcp://" + to_dial(effect.address)); !sent) {
    log_limited(limit_, read_clocks().mono, Level::warning, "dial_failed", sent.error().what);
  }
  return Done{};
}

void RouterShell::close_link(LinkId link) {
  if (const auto accepted = accepted_.find(link); accepted != accepted_.end()) {
    inbox_guard_.leave(accepted->second.pending);
    accepted_.erase(accepted);
  }
  lane_->link_closed(link);
  close_heard(link);
  core_.seals().forget(link);
  proof_->ended(link, read_clocks().utc, "closed");
  held_.erase(link);
  const auto at = dialled_.find(link);
  if (at == dialled_.end()) return;
  if (!at->second.name.empty()) resolver_->ended(at->second.name, read_clocks().mono);
  loop_.remove_socket(at->second.socket->handle());
  closed_.push_back(std::move(at->second));
  dialled_.erase(at);
}

bool RouterShell::link_has_room(LinkId link, std::size_t bytes) const {
  if (bytes < kCountedFrame) return true;
  if (const auto at = dialled_.find(link); at != dialled_.end()) return at->second.budget->has_room(bytes);
  const auto at = accepted_.find(link);
  return at == accepted_.end() || at->second.budget->has_room(bytes);
}

SendResult RouterShell::send_link(LinkId link, Frame&& frame) {
  if (!link_has_room(link, frame.size())) return SendResult::full;
  const Outgoing outgoing = core_.seals().send(link, static_cast<char*>(frame.data()), frame.size(), read_clocks());
  return put_outgoing(link, outgoing, std::move(frame));
}

SendResult RouterShell::put_on_link(LinkId link, Frame&& frame) {
  if (const auto at = dialled_.find(link); at != dialled_.end()) {
    Socket& socket = *at->second.socket;
    return send_within(at->second.budget, frame, [&](Frame&& one) { return socket.send(std::move(one)); });
  }
  const auto at = accepted_.find(link);
  if (at == accepted_.end()) return SendResult::unroutable;
  const Accepted& accepted = at->second;
  return send_within(accepted.budget, frame,
                     [&](Frame&& one) { return inbox_->send_to(accepted.routing_id, std::move(one)); });
}

void RouterShell::on_bad_frame(LinkId link, const Error& error) {
  Effects effects;
  core_.links().on_bad_frame(link, error, read_clocks(), effects);
  carry_out(effects);
}

/// Where the nodes are that were linked before: a crowd of strangers keeps none of them from coming back.
std::vector<std::string> RouterShell::sources_of_peers() const {
  std::vector<std::string> out;
  for (const auto& [id, peer] : core_.table().peers()) {
    if (!peer.met) continue;
    for (const std::string& address : {peer.address, peer.good_address}) {
      const std::string host = split_endpoint(address).host;
      if (!host.empty()) out.push_back(source_of(without_scope(host)));
    }
  }
  return out;
}

void RouterShell::on_source_blocked(const std::string& source) {
  core_.counters().count("refused.source_blocked");
  log_limited(limit_, read_clocks().mono, Level::warning, "source_blocked",
              source + " has too many connections that prove nothing; its new ones are dropped for 10 s");
}

void RouterShell::on_pending_cut(const std::string& address) {
  core_.counters().count("cut.no_link");
  log_limited(limit_, read_clocks().mono, Level::warning, "no_link",
              "the connection of " + address + " has become no link in time and was cut");
}

void RouterShell::on_inbox_event(LinkEvent event, int fd) {
  // Of a client of ZMTP 1 or 2, in which there is no CURVE, libzmq tells nothing but its end.
  if (event == LinkEvent::disconnected && inbox_guard_.is_undecided(fd)) core_.counters().count("ended.no_link");
  inbox_guard_.on_event(event, fd);
  if (event == LinkEvent::failed && fd >= 0) return;  // the listening socket itself was closed
  switch (event) {
    case LinkEvent::accept_failed:
      core_.counters().count("refused.no_descriptor");
      log_limited(limit_, read_clocks().mono, Level::error, "no_descriptor",
                  "a connection could not be taken: raise the limit of open files (ulimit -n)");
      break;
    case LinkEvent::listening:
    case LinkEvent::accepted:
      break;
    case LinkEvent::no_curve:
      core_.counters().count("refused.no_curve");
      log_limited(limit_, read_clocks().mono, Level::warning, "no_curve", "a client without CURVE was refused");
      break;
    case LinkEvent::wrong_server_key:
      core_.counters().count("refused.wrong_server_key");
      log_limited(limit_, read_clocks().mono, Level::warning, "wrong_server_key",
                  "a client dialled with a wrong server key");
      break;
    case LinkEvent::refused_key:
      core_.counters().count("refused.key");
      break;
    case LinkEvent::protocol_error:
    case LinkEvent::failed:
      core_.counters().count("refused.no_zmtp");
      log_limited(limit_, read_clocks().mono, Level::warning, "no_zmtp",
                  "a client that does not speak ZMTP, or left during the handshake");
      break;
    case LinkEvent::connected:
    case LinkEvent::disconnected:
      break;
  }
}

}  // namespace trb::router
