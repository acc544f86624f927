#include "services/router/io/inbox_socket.hpp"

#include <algorithm>

#include "common/base/hex.hpp"
#include "common/base/on_wire.hpp"
#include "common/transport/socket.hpp"
#include "services/router/io/frame_forwarder.hpp"
#include "services/router/io/own_frame.hpp"
#include "services/router/io/peer_sources.hpp"
#include "services/router/io/turn_budget.hpp"

namespace trb::router {
namespace {

/// The key that the frame's connection has proven; nothing if it is not 32 bytes long.
std::optional<Bytes> key_of(const Frame& frame) {
  auto key = from_hex(user_id(frame));
  if (!key || key->size() != 32) return std::nullopt;
  return std::move(*key);
}

}  // namespace

InboxSocket::InboxSocket(ShellContext& shell, FrameForwarder& forwarder, CurveKeys keys,
                         const PendingConnectionLimits& limits)
    : shell_(shell),
      forwarder_(forwarder),
      keys_(std::move(keys)),
      guard_(
          shell.loop(), limits,
          [this](const std::string& source) {
            shell_.count("refused.source_blocked");
            shell_.log(Level::warning, "source_blocked",
                       source + " has too many connections that prove nothing; its new ones are dropped for 10 s");
          },
          [this](const std::string& address) {
            shell_.count("cut.no_link");
            shell_.log(Level::warning, "no_link",
                       "the connection of " + address + " has become no link in time and was cut");
          }) {
  guard_.set_friends([this] { return sources_of_peers(shell_.core().table()); });
  guard_.set_on_incomplete(
      [this](PendingConnectionId pending, const std::string& address) { on_incomplete(pending, address); });
}

void InboxSocket::close() {
  accepted_.clear();
  if (socket_) shell_.loop().remove_socket(socket_->handle());
  monitor_.reset();
  socket_.reset();
  guard_.reset();
}

Status InboxSocket::open(const std::string& endpoint) {
  close();
  auto made = Socket::inbox(shell_.zmq(), "", keys_);
  if (!made) return made.error();
  // The monitor starts before the port opens: it must see every connection, and the listening socket itself.
  auto& socket = socket_.emplace(std::move(*made));
  auto monitor = SocketMonitor::watch(shell_.zmq(), shell_.loop(), socket,
                                      [this](LinkEvent event, int fd) { on_event(event, fd); });
  if (!monitor) {
    socket_.reset();
    return monitor.error();
  }
  monitor_ = std::move(*monitor);
  shell_.loop().add_socket(
      socket.handle(), [this] { drain(); }, socket.unseen());
  return endpoint.empty() ? Status(Done{}) : socket.bind(endpoint);
}

Status InboxSocket::bind(const std::string& endpoint) {
  monitor_->catch_up();  // it is an event, too, and must find room
  return socket_->bind(endpoint);
}

void InboxSocket::accept(LinkId link) {
  accepted_[link] = {origin_.routing_id, origin_.user, origin_.pending, new_link_queue(shell_),
                     guard_.carries(origin_.pending)};
  guard_.linked(origin_.pending);
}

void InboxSocket::refuse(const RefuseCandidate& refuse) {
  if (origin_.routing_id.empty()) return;
  if (auto frame = encode_own(shell_, refuse.message)) {
    stamp_link(frame->data(), refuse.link, 1, refuse.message.remaining_ms);
    stamp_version(frame->data(), refuse.version);
    socket_->send_to(origin_.routing_id, to_frame(*frame));
  }
  guard_.leave(origin_.pending);
}

void InboxSocket::close_link(LinkId link) {
  const auto at = accepted_.find(link);
  if (at == accepted_.end()) return;
  guard_.leave(at->second.pending);
  accepted_.erase(at);
}

std::optional<bool> InboxSocket::has_room(LinkId link, std::size_t bytes) const {
  const auto at = accepted_.find(link);
  if (at == accepted_.end()) return std::nullopt;
  return at->second.queue->has_room(bytes);
}

std::optional<bool> InboxSocket::has_share(LinkId link, std::string_view peer, std::size_t bytes) {
  const auto at = accepted_.find(link);
  if (at == accepted_.end()) return std::nullopt;
  return at->second.queue->has_share(peer, bytes);
}

SendResult InboxSocket::send(LinkId link, Frame&& frame, std::string_view peer) {
  const auto at = accepted_.find(link);
  if (at == accepted_.end()) return SendResult::unroutable;
  const Accepted& accepted = at->second;
  return accepted.queue->send(peer, frame,
                              [&](Frame&& one) { return socket_->send_to(accepted.routing_id, std::move(one)); });
}

void InboxSocket::drain() {
  Frame routing_id;
  Frame frame;
  TurnBudget turn(shell_);
  while (turn.has_left()) {
    if (!socket_->receive(routing_id)) return guard_.on_empty();
    turn.take_message();
    if (!routing_id.more() || !socket_->receive(frame)) continue;
    turn.take_bytes(frame.size());
    if (frame.more()) {
      on_parts(view_of(routing_id), frame);
    } else {
      on_frame(view_of(routing_id), frame);
    }
  }
  guard_.on_turn(turn.messages());
}

void InboxSocket::on_parts(BytesView routing_id, const Frame& first) {
  shell_.count("refused.malformed");
  Accepted* from = sender(routing_id, first);
  const std::uint64_t bytes = on_wire(first.size()) + socket_->skip_rest(first);
  if (from != nullptr) from->incomplete->add_on_wire(bytes);
}

/// The link whose connection the frame came on, whatever link it names.
InboxSocket::Accepted* InboxSocket::sender(BytesView routing_id, const Frame& frame) {
  const auto at = std::find_if(accepted_.begin(), accepted_.end(), [&](const auto& row) {
    return row.second.routing_id == routing_id && row.second.user == user_id(frame);
  });
  return at == accepted_.end() ? nullptr : &at->second;
}

void InboxSocket::look(const LookPart& part) {
  if (!socket_) return;
  monitor_->catch_up();
  if (guard_.look(0, part)) drain();
}

void InboxSocket::on_incomplete(PendingConnectionId pending, const std::string& address) {
  const auto at =
      std::find_if(accepted_.begin(), accepted_.end(), [&](const auto& row) { return row.second.pending == pending; });
  if (at == accepted_.end()) {
    shell_.count("cut.incomplete");
    return shell_.log(Level::warning, "incomplete",
                      "the connection of " + address + " sent much before it became a link, and was cut");
  }
  Effects effects;
  shell_.core().links().on_incomplete(at->first, read_clocks(), effects);
  shell_.carry_out(effects);
}

PendingConnectionId InboxSocket::pending_of(const Frame& frame) {
  monitor_->catch_up();  // another connection may have had this descriptor a moment ago
  return guard_.pending(connection_fd(frame));
}

void InboxSocket::on_frame(BytesView routing_id, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  if (!header) return on_undecoded(routing_id, frame, header.error());
  const auto link = accepted_.find(header->link);
  const bool proven =
      link != accepted_.end() && link->second.routing_id == routing_id && link->second.user == user_id(frame);
  if (proven) {
    link->second.incomplete->add(frame.size());
    return forwarder_.from_link(header->link, *header, frame);
  }
  if (Accepted* from = sender(routing_id, frame)) from->incomplete->add(frame.size());
  on_unproven(routing_id, *header, frame);
}

void InboxSocket::on_undecoded(BytesView routing_id, const Frame& frame, const Error& error) {
  const bool other_version = error.code == Errc::version_mismatch;
  if (other_version && pending_of(frame) != 0 && is_undecided(frame)) return on_other_version(routing_id, frame);
  const auto from = std::find_if(accepted_.begin(), accepted_.end(), [&](const auto& row) {
    return row.second.routing_id == routing_id && row.second.user == user_id(frame);
  });
  if (from == accepted_.end()) guard_.leave(pending_of(frame));
  on_bad_frame(from == accepted_.end() ? 0 : from->first, error);
}

/// The first frame of a connection, in another version of the wire.
void InboxSocket::on_other_version(BytesView routing_id, const Frame& frame) {
  const auto header = decode_frame_of_any_version(view_of(frame));
  const auto key = key_of(frame);
  const PendingConnectionId pending = pending_of(frame);
  const std::uint8_t version = wire_version(view_of(frame));
  if (!header || !key) {
    guard_.leave(pending);
    return on_bad_frame(0, fail(Errc::version_mismatch, "wire version " + std::to_string(version)));
  }
  origin_ = {Bytes(routing_id), Bytes(user_id(frame)), pending};
  Effects effects;
  shell_.core().handshake().on_other_version(0, *key, version, *header, read_clocks(), effects);
  shell_.carry_out(effects);
  origin_ = {};
}

/// A frame that names no link, or one that is not its connection's.
void InboxSocket::on_unproven(BytesView routing_id, const HeaderView& header, const Frame& frame) {
  const bool of_another = accepted_.count(header.link) != 0;
  const auto key = key_of(frame);
  if (!key) return shell_.count("refused.no_key");
  origin_ = {Bytes(routing_id), Bytes(user_id(frame)), pending_of(frame)};
  Effects effects;
  if (of_another) {
    LinkInbox::refuse_theft(effects);
  } else if (is_undecided(frame)) {
    forwarder_.from_stranger(*key, header, frame, effects);
  } else {
    on_later_frame(effects);
  }
  shell_.carry_out(effects);
  origin_ = {};
}

/// A connection that is, or was, a link says Hello again.
void InboxSocket::on_later_frame(Effects& effects) {
  const auto own = std::find_if(accepted_.begin(), accepted_.end(),
                                [&](const auto& row) { return row.second.pending == origin_.pending; });
  if (own == accepted_.end()) return effects.count("dropped.closed_link");
  shell_.core().links().on_second_link(own->first, read_clocks(), effects);
}

void InboxSocket::on_bad_frame(LinkId link, const Error& error) {
  Effects effects;
  shell_.core().links().on_bad_frame(link, error, read_clocks(), effects);
  shell_.carry_out(effects);
}

void InboxSocket::on_event(LinkEvent event, int fd) {
  // For a client of ZMTP 1 or 2, which have no CURVE, libzmq reports only the end.
  if (event == LinkEvent::disconnected && guard_.is_undecided(fd)) shell_.count("ended.no_link");
  guard_.on_event(event, fd);
  if (event == LinkEvent::failed && fd >= 0) return;  // the listening socket itself was closed
  switch (event) {
    case LinkEvent::accept_failed:
      shell_.count("refused.no_descriptor");
      return shell_.log(Level::error, "no_descriptor",
                        "a connection could not be taken: raise the limit of open files (ulimit -n)");
    case LinkEvent::no_curve:
      return refused("no_curve", "a client without CURVE was refused");
    case LinkEvent::wrong_server_key:
      return refused("wrong_server_key", "a client dialled with a wrong server key");
    case LinkEvent::refused_key:
      return shell_.count("refused.key");
    case LinkEvent::protocol_error:
    case LinkEvent::failed:
      return refused("no_zmtp", "a client that does not speak ZMTP, or left during the handshake");
    default:
      return;
  }
}

void InboxSocket::refused(const char* name, const char* text) {
  shell_.count("refused." + std::string(name));
  shell_.log(Level::warning, name, text);
}

}  // namespace trb::router
