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

Routing RouterCore::route_local(ConnectionId from, const HeaderView& header) {
  const Connection* connection = services_.find(from);
  if (connection == nullptr) return drop(Errc::no_service);
  if (header.source != config_.id) return drop(Errc::source_mismatch);
  if (header.id >> 48U != connection->slot) return drop(Errc::malformed);
  if (header.remaining_ms == 0) return drop(Errc::expired);
  if (header.target == config_.id) {
    const ServiceHello& by = connection->hello;
    if (!may_say(by.service, connection->probe, header.subtype)) return drop(Errc::not_permitted);
    const Routing own = route_to_self(header);
    // What a robot says to its own node and nobody takes must not come back to it as fields.
    const bool echo = own.to == Routing::To::service && own.connection == from && header.reply_to == 0;
    return echo ? drop(Errc::no_service) : own;
  }
  if (!may_send_out(config_.role, header.subtype)) return drop(Errc::not_permitted);
  if (header.target == kEveryNode) {
    const bool good = header.type == MessageType::information;
    return good ? Routing{.to = Routing::To::every_peer} : drop(Errc::bad_value);
  }
  const auto peer = peers_.find(header.target);
  if (peer == peers_.end()) return drop(Errc::unknown_target);
  if (const Link* relay = peer->second.link == 0 ? relay_of(peer->second) : nullptr)
    return {.to = Routing::To::relay, .link = relay->id};
  if (peer->second.link == 0) return drop(peer->second.expired ? Errc::peer_expired : Errc::peer_unreachable);
  return {.to = Routing::To::peer, .link = peer->second.link};
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
  return route_to_self(header);
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
  return route_to_self(header);
}

Routing RouterCore::route_to_self(const HeaderView& header) const {
  const auto to_service = [](std::optional<ConnectionId> connection) {
    if (!connection) return drop(Errc::no_service);
    return Routing{.to = Routing::To::service, .connection = *connection};
  };
  // Only information answers: else a peer could bring a command past the claims, straight to a service of its choice.
  if (header.reply_to != 0 && header.type != MessageType::information) return drop(Errc::bad_value);
  if (header.reply_to != 0) return to_service(services_.by_slot(static_cast<std::uint16_t>(header.reply_to >> 48U)));
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

bool deserves_nack(const HeaderView& header) {
  if (header.reply_to != 0 || header.id == 0 || is_lossy(header)) return false;
  return header.type != MessageType::information || !is_typed(header.subtype);
}

void RouterCore::nack_local(ConnectionId from, const HeaderView& header, Errc reason, Effects& out) {
  const bool forbidden = reason == Errc::not_permitted;
  out.count((forbidden ? "refused." : "dropped.") + std::string(errc_name(reason)));
  if (const Connection* by = services_.find(from); forbidden && by != nullptr) {
    out.log(LogLevel::warning, "not_permitted",
            "service '" + by->hello.service + "' (pid " + std::to_string(by->hello.pid) + ") said " +
                std::string(header.subtype) + ", which is not its word: trb help rights");
  }
  if (!deserves_nack(header)) return;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  out.add(BusSend{from, std::move(message)});
}

void RouterCore::nack_peer(LinkId from, const HeaderView& header, Errc reason, Effects& out) {
  out.count((reason == Errc::source_mismatch || reason == Errc::not_permitted || reason == Errc::unknown_peer_key
                 ? "refused."
                 : "dropped.") +
            std::string(errc_name(reason)));
  const auto at = links_.find(from);
  if (at == links_.end() || !at->second.up || header.source != at->second.peer || !deserves_nack(header)) return;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  out.add(LinkSend{from, std::move(message)});
}

std::optional<Message> RouterCore::nack_relayed(const HeaderView& header, Errc reason, Effects& out) {
  out.count((reason == Errc::not_permitted ? "refused." : "dropped.") + std::string(errc_name(reason)));
  if (!deserves_nack(header)) return std::nullopt;
  Message message = make_nack(header, reason);
  message.id = ++message_count_;
  return message;
}

}  // namespace trb::router
