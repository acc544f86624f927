// The road of a message: decided on the header alone.
#include <algorithm>
#include <utility>

#include "common/security/rights.hpp"
#include "services/router/core/nack.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

// Sorted: the router itself takes these.
constexpr std::string_view kOwnSubtypes[] = {
    EchoRequest::kSubtype,
    FleetNews::kSubtype,
    Goodbye::kSubtype,
    Hello::kSubtype,
    KeepAlive::kSubtype,
    LinkTroublesRequest::kSubtype,
    Neighbours::kSubtype,
    NodeProfile::kSubtype,
    NodeSensors::kSubtype,
    RelayRefused::kSubtype,
    Relayed::kSubtype,
    RouteListRequest::kSubtype,
    RouterCountersRequest::kSubtype,
    Seal::kSubtype,
    ServiceAlive::kSubtype,
    ServiceHello::kSubtype,
    ServiceListRequest::kSubtype,
    SignRequest::kSubtype,
};
static_assert(std::is_sorted(std::begin(kOwnSubtypes), std::end(kOwnSubtypes)));

template <std::size_t N>
bool contains(const std::string_view (&words)[N], std::string_view word) {
  return std::binary_search(std::begin(words), std::end(words), word);
}

Routing drop(Errc reason) {
  return {.reason = reason};
}

bool is_refusal(Errc reason) {
  return reason == Errc::source_mismatch || reason == Errc::not_permitted || reason == Errc::unknown_peer_key ||
         reason == Errc::not_asked;
}

/// Nor, on another node, for what becomes of a word to every node.
bool waits_elsewhere(const HeaderView& header) {
  return header.target != kEveryNode && deserves_nack(header);
}

std::string_view cure_of(Errc reason) {
  switch (reason) {
    case Errc::unknown_target:
      return "see trb route list for the nodes that were heard";
    case Errc::peer_expired:
    case Errc::peer_unreachable:
      return "see trb route list; check the node's power and cable";
    case Errc::queue_full:
      return "send less, or wait";
    case Errc::no_service:
      return "see trb service list on the target; is the service in its node.json?";
    case Errc::not_permitted:
      return "it is not for this role or service to say: trb help rights";
    case Errc::expired:
      return "give the message more time";
    case Errc::not_confirmed:
      return "it may or may not have come: ask for the state before you say it again";
    case Errc::bad_value:
      return "only information goes to every node, and only information answers";
    default:
      return "";
  }
}

}  // namespace

bool deserves_nack(const HeaderView& header) {
  if (header.reply_to != 0 || header.id == 0 || is_lossy(header)) return false;
  return header.type != MessageType::information || !is_typed(header.subtype);
}

Routing RouterCore::route_local(ConnectionId from, const HeaderView& header) {
  const Connection* connection = services_.find(from);
  if (connection == nullptr) return drop(Errc::no_service);
  if (header.source != config_.id) return drop(Errc::source_mismatch);
  if (header.id >> 48U != connection->slot) return drop(Errc::malformed);
  if (header.remaining_ms == 0) return drop(Errc::expired);
  if (header.target == config_.id) {
    const ServiceHello& by = connection->hello;
    if (!may_say(by.service, connection->probe, header.subtype)) return drop(Errc::not_permitted);
    const Routing own = route_to_self(header, party_of_connection(from));
    // What a robot says to its own node and nobody takes must not come back to it as fields.
    const bool echo = own.to == Routing::To::service && own.connection == from && header.reply_to == 0;
    if (echo) return drop(Errc::no_service);
    if (own.to == Routing::To::service) note_asked(from, header, party_of_connection(own.connection));
    return own;
  }
  if (!may_send_out(config_.role, header.subtype)) return drop(Errc::not_permitted);
  if (header.target == kEveryNode) {
    const bool good = header.type == MessageType::information;
    return good ? Routing{.to = Routing::To::every_peer} : drop(Errc::bad_value);
  }
  const auto peer = peers_.find(header.target);
  if (peer == peers_.end()) return drop(Errc::unknown_target);
  const Party whom = party_of_peer(peer->second.number);
  if (const Link* relay = peer->second.link == 0 ? relay_of(peer->second) : nullptr) {
    note_asked(from, header, whom);
    return {.to = Routing::To::relay, .link = relay->id};
  }
  if (peer->second.link == 0) return drop(peer->second.expired ? Errc::peer_expired : Errc::peer_unreachable);
  note_asked(from, header, whom);
  return {.to = Routing::To::peer, .link = peer->second.link};
}

void RouterCore::note_asked(ConnectionId from, const HeaderView& header, Party whom) {
  if (header.reply_to != 0 || header.id == 0) return;
  const bool question = header.type != MessageType::information;
  if (question || deserves_nack(header)) services_.asked_of(from)->note(header.id, question, whom);
}

Routing RouterCore::route_peer(LinkId id, const HeaderView& header, Now now, Effects& out) {
  const auto at = links_.find(id);
  if (at == links_.end()) return drop(Errc::unknown_peer_key);
  Link& link = at->second;
  if (header.sequence != link.heard + 1 && link.up) {
    out.count("refused.sequence");
    const std::string why = "sequence " + std::to_string(header.sequence) + " after " + std::to_string(link.heard);
    out.log(LogLevel::warning, "sequence_gap", link.peer + ": " + why);
    drop_link(id, why, true, now, out);
    return drop(Errc::conflict);
  }
  link.heard = header.sequence;
  link.last_heard = now.mono;
  if (!link.up) return {.to = Routing::To::router};
  if (header.source != link.peer) {
    out.log(LogLevel::warning, "source_mismatch",
            "link of " + link.peer + " carried source " + std::string(header.source));
    return drop(Errc::source_mismatch);
  }
  if (const auto hello = std::exchange(link.waiting, std::nullopt)) {
    carry_by(link, *hello, now, out);
    if (links_.count(id) == 0) return drop(Errc::conflict);
  }
  if (header.target != config_.id && header.target != kEveryNode) return drop(Errc::unknown_target);
  if (const Role role = peers_.at(link.peer).certificate.role; !may_cross(role, header.subtype)) {
    out.log(LogLevel::warning, "not_permitted",
            link.peer + " sent " + std::string(header.subtype) + ", which a " + std::string(name_of(role)) +
                " node may not send to another node: trb help rights");
    return drop(Errc::not_permitted);
  }
  if (header.remaining_ms == 0) return drop(Errc::expired);
  return route_from(peers_.at(link.peer), header, out);
}

/// The words of a link have no meaning by a relay; what one node keeps to itself stays there by any road.
Routing RouterCore::route_relayed(const HeaderView& header, const Certificate& source, Effects& out) const {
  if (!may_send_out(source.role, header.subtype)) {
    out.log(LogLevel::warning, "not_permitted",
            source.id + ", a " + std::string(name_of(source.role)) + ", sent " + std::string(header.subtype) +
                " by a relay");
    return drop(Errc::not_permitted);
  }
  if (header.remaining_ms == 0) return drop(Errc::expired);
  return route_from(peers_.at(source.id), header, out);
}

/// What another node has for this one, by whatever way.
Routing RouterCore::route_from(const Peer& peer, const HeaderView& header, Effects& out) const {
  const Routing own = route_to_self(header, party_of_peer(peer.number));
  if (own.reason == Errc::not_asked) {
    out.log(LogLevel::warning, "not_asked",
            peer.id + " sent " + std::string(header.subtype) + " as an answer to what '" +
                asker_of(header.reply_to)->hello.service + "' of " + config_.id + " did not ask of it");
  }
  return own;
}

const Connection* RouterCore::asker_of(std::uint64_t reply_to) const {
  const auto connection = services_.by_slot(static_cast<std::uint16_t>(reply_to >> 48U));
  return connection ? services_.find(*connection) : nullptr;
}

Routing RouterCore::route_to_self(const HeaderView& header, Party from) const {
  const auto to_service = [](std::optional<ConnectionId> connection) {
    if (!connection) return drop(Errc::no_service);
    return Routing{.to = Routing::To::service, .connection = *connection};
  };
  // Only information answers: else a peer could bring a command past the claims, straight to a service of its choice.
  if (header.reply_to != 0 && header.type != MessageType::information) return drop(Errc::bad_value);
  if (header.reply_to != 0) {
    const Connection* asker = asker_of(header.reply_to);
    if (asker == nullptr) return drop(Errc::no_service);
    if (!asker->asked.may_answer(header.reply_to, header.subtype == Nack::kSubtype, from)) return drop(Errc::not_asked);
    return to_service(services_.by_slot(asker->slot));
  }
  if (contains(kOwnSubtypes, header.subtype)) return {.to = Routing::To::router};
  if (const auto claimed = services_.by_subtype(header.subtype)) return to_service(claimed);
  if (is_typed(header.subtype)) return drop(Errc::no_service);
  // Who asks for a plugged sensor by its name means its value; commands of that name are the robot's.
  const bool asks = header.type == MessageType::request && is_plugged(header.subtype);
  return to_service(services_.holder(asks ? "sensor-bus" : "mode-adapter"));
}

std::vector<LinkId> RouterCore::up_links() const {
  std::vector<LinkId> out;
  for (const auto& [id, peer] : peers_) {
    if (peer.link != 0) out.push_back(peer.link);
  }
  return out;
}

Message RouterCore::make_nack(const HeaderView& header, Errc reason) const {
  const std::string target(header.target);
  const Nack body{
      std::string(errc_name(reason)), std::string(header.subtype), target,
      "router of " + config_.id + ": " + std::string(header.subtype) + " for '" + target + "' not delivered",
      std::string(cure_of(reason))};
  Message message;
  message.type = MessageType::information;
  message.subtype = Nack::kSubtype;
  message.source = config_.id;
  message.target = header.source;
  message.reply_to = header.id;
  message.data = encode(body);
  return message;
}

void RouterCore::nack_local(ConnectionId from, const HeaderView& header, Errc reason, Effects& out) {
  const bool forbidden = reason == Errc::not_permitted;
  const bool not_asked = reason == Errc::not_asked;
  out.count((forbidden || not_asked ? "refused." : "dropped.") + std::string(errc_name(reason)));
  if (const Connection* by = services_.find(from); (forbidden || not_asked) && by != nullptr) {
    const Connection* asker = not_asked ? asker_of(header.reply_to) : nullptr;
    out.log(LogLevel::warning, std::string(errc_name(reason)),
            "service '" + by->hello.service + "' (pid " + std::to_string(by->hello.pid) + ") said " +
                std::string(header.subtype) +
                (asker == nullptr ? ", which is not its word: trb help rights"
                                  : " as an answer to what '" + asker->hello.service + "' did not ask of it"));
  }
  if (!deserves_nack(header)) return;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  out.add(BusSend{from, std::move(message)});
}

void RouterCore::nack_peer(LinkId from, const HeaderView& header, Errc reason, Effects& out) {
  out.count((is_refusal(reason) ? "refused." : "dropped.") + std::string(errc_name(reason)));
  const auto at = links_.find(from);
  if (at == links_.end() || !at->second.up || header.source != at->second.peer || !waits_elsewhere(header)) return;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  out.add(LinkSend{from, std::move(message)});
}

std::optional<Message> RouterCore::nack_relayed(const HeaderView& header, Errc reason, Effects& out) {
  out.count((is_refusal(reason) ? "refused." : "dropped.") + std::string(errc_name(reason)));
  if (!waits_elsewhere(header)) return std::nullopt;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  return message;
}

}  // namespace trb::router
