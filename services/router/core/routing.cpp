#include "services/router/core/routing.hpp"

#include <array>
#include <utility>

#include "common/base/lookup_table.hpp"
#include "common/security/rights.hpp"

namespace trb::router {
namespace {

// The router itself takes these.
constexpr WordIndex kOwnSubtypes(std::to_array<std::string_view>({
    EchoRequest::kSubtype,
    TrustUpdate::kSubtype,
    Goodbye::kSubtype,
    Hello::kSubtype,
    HoldInvitation::kSubtype,
    KeepAlive::kSubtype,
    LinkErrorTableRequest::kSubtype,
    ReachablePeerList::kSubtype,
    NodeProfile::kSubtype,
    NodeSensors::kSubtype,
    RelayRefused::kSubtype,
    Relayed::kSubtype,
    RouteListRequest::kSubtype,
    RouterCountersRequest::kSubtype,
    Seal::kSubtype,
    ServiceAlive::kSubtype,
    ServiceCountersRequest::kSubtype,
    ServiceHello::kSubtype,
    ServiceListRequest::kSubtype,
    SignRequest::kSubtype,
}));
bool is_own(std::string_view subtype) {
  return kOwnSubtypes.find(subtype) != decltype(kOwnSubtypes)::kNone;
}

Routing drop(Errc reason) {
  return {.reason = reason};
}

Routing to_service(std::optional<ConnectionId> connection) {
  if (!connection) return drop(Errc::no_service);
  return {.to = Routing::To::service, .connection = *connection};
}

}  // namespace

Routing MessageRouting::from_bus(ConnectionId from, const HeaderView& header) {
  const Connection* connection = bus_.services().find(from);
  if (connection == nullptr) return drop(Errc::no_service);
  if (header.source != node_.id()) return drop(Errc::source_mismatch);
  if (header.id >> 48U != connection->slot) return drop(Errc::malformed);
  const bool visits = header.target == node_.id() && may_visitor_send(header.subtype);
  if (connection->member == Member::visitor && !visits) return drop(Errc::not_permitted);
  if (header.remaining_ms == 0) return drop(Errc::expired);
  if (header.target == node_.id()) return from_bus_to_self(from, *connection, header);
  if (!may_send_out(node_.config().role, header.subtype)) return drop(Errc::not_permitted);
  if (header.target != kEveryNode) return from_bus_to_peer(from, header);
  const bool good = header.type == MessageType::information;
  return good ? Routing{.to = Routing::To::every_peer} : drop(Errc::bad_value);
}

Routing MessageRouting::from_bus_to_self(ConnectionId from, const Connection& by, const HeaderView& header) {
  if (!may_send_on_bus(by.hello.service, by.member == Member::probe, header.subtype)) return drop(Errc::not_permitted);
  const Routing own = to_self(header, party_of_connection(from));
  // What a robot sends to its own node and no service takes must not come back to the robot.
  const bool echo = own.to == Routing::To::service && own.connection == from && header.reply_to == 0;
  if (echo) return drop(Errc::no_service);
  if (own.to == Routing::To::service) bus_.note_request(from, header, party_of_connection(own.connection));
  return own;
}

Routing MessageRouting::from_bus_to_peer(ConnectionId from, const HeaderView& header) {
  const Peer* peer = std::as_const(table_).find(header.target);
  if (peer == nullptr) return drop(Errc::unknown_target);
  const Link* relay = peer->link == 0 ? relays_.relay_of(*peer) : nullptr;
  if (peer->link == 0 && relay == nullptr) return drop(peer->expired ? Errc::peer_expired : Errc::peer_unreachable);
  bus_.note_request(from, header, party_of_peer(peer->number));
  if (relay != nullptr) return {.to = Routing::To::relay, .link = relay->id};
  return {.to = Routing::To::peer, .link = peer->link};
}

Routing MessageRouting::from_link(const Link& link, const HeaderView& header, Effects& out) const {
  if (header.target != node_.id() && header.target != kEveryNode) return drop(Errc::unknown_target);
  const Peer& peer = *std::as_const(table_).find(link.peer);
  if (const Role role = peer.certificate.role; !may_cross(role, header.subtype)) {
    out.log(LogLevel::warning, "not_permitted",
            link.peer + " sent " + std::string(header.subtype) + ", which a " + std::string(name_of(role)) +
                " node may not send to another node: trb help rights");
    return drop(Errc::not_permitted);
  }
  if (header.remaining_ms == 0) return drop(Errc::expired);
  return from_peer(peer, header, out);
}

/// A link's messages have no meaning by a relay; what one node keeps to itself stays there on any way.
Routing MessageRouting::from_relay(const Peer& source, const HeaderView& header, Effects& out) const {
  const Role role = source.certificate.role;
  if (!may_send_out(role, header.subtype)) {
    out.log(LogLevel::warning, "not_permitted",
            source.id + ", a " + std::string(name_of(role)) + ", sent " + std::string(header.subtype) + " by a relay");
    return drop(Errc::not_permitted);
  }
  if (header.remaining_ms == 0) return drop(Errc::expired);
  return from_peer(source, header, out);
}

Routing MessageRouting::from_lane(LinkId id, const HeaderView& header, Effects& out) const {
  const Link* link = table_.link(id);
  if (link == nullptr || !link->up) return drop(Errc::unknown_peer_key);
  const auto refuse = [&](Errc reason, std::string_view name) {
    out.count("refused.lane_" + std::string(name));
    out.log(LogLevel::warning, "lane_" + std::string(name),
            link->peer + " sent " + std::string(header.subtype) + " of '" + std::string(header.source) + "' for '" +
                std::string(header.target) + "' by its lane");
    return drop(reason);
  };
  if (!is_lossy(header)) return refuse(Errc::bad_value, "not_lossy");
  if (header.source != link->peer) return refuse(Errc::source_mismatch, "source_mismatch");
  if (header.target != node_.id() && header.target != kEveryNode) return refuse(Errc::unknown_target, "wrong_target");
  const Peer& peer = *table_.find(link->peer);
  // A link's messages have no meaning here, nor what a node keeps to itself.
  if (!may_send_out(peer.certificate.role, header.subtype)) return refuse(Errc::not_permitted, "not_permitted");
  const Routing own = header.remaining_ms == 0 ? drop(Errc::expired) : from_peer(peer, header, out);
  if (own.to == Routing::To::router) return refuse(Errc::not_permitted, "not_permitted");
  if (own.to == Routing::To::drop)
    out.count((own.reason == Errc::not_asked ? "refused." : "dropped.") + std::string(errc_name(own.reason)));
  return own;
}

Routing MessageRouting::lossy(std::string_view to, std::size_t size, Now now) {
  Peer* peer = table_.find(to);
  if (peer == nullptr) return drop(Errc::unknown_target);
  const Link* link = table_.link(peer->link);
  if (link != nullptr && lanes_.listens(link->id)) return {.to = Routing::To::lane, .link = link->id};
  const Link* relay = link == nullptr ? relays_.relay_of(*peer) : nullptr;
  if (link == nullptr && relay == nullptr) return drop(Errc::peer_unreachable);
  if (!peer->spare.take(size, now.mono)) {
    counters_.count("dropped.no_lane");
    return drop(Errc::queue_full);
  }
  if (link != nullptr) return {.to = Routing::To::peer, .link = link->id};
  return {.to = Routing::To::relay, .link = relay->id};
}

/// A message from another node for this one, on any way.
Routing MessageRouting::from_peer(const Peer& peer, const HeaderView& header, Effects& out) const {
  const Routing own = to_self(header, party_of_peer(peer.number));
  if (own.reason == Errc::not_asked) {
    out.log(LogLevel::warning, "not_asked",
            peer.id + " sent " + std::string(header.subtype) + " as an answer to what '" +
                bus_.requester_of(header.reply_to)->hello.service + "' of " + node_.id() + " did not ask of it");
  }
  return own;
}

Routing MessageRouting::to_self(const HeaderView& header, Party from) const {
  if (header.reply_to == 0) return to_router_or_service(header);
  // Only information can be an answer: else a peer could bring a command to a service that does not claim it.
  if (header.type != MessageType::information) return drop(Errc::bad_value);
  const Connection* requester = bus_.requester_of(header.reply_to);
  if (requester == nullptr) return drop(Errc::no_service);
  if (!requester->sent.may_answer(header.reply_to, header.subtype == Nack::kSubtype, from))
    return drop(Errc::not_asked);
  return to_service(bus_.services().by_slot(requester->slot));
}

/// The one request whose data says which service answers it. Nothing: the router does, or refuses it.
std::optional<ConnectionId> MessageRouting::counting_service(const HeaderView& header) const {
  if (header.type != MessageType::request || header.subtype != ServiceCountersRequest::kSubtype) return std::nullopt;
  const auto request = decode<ServiceCountersRequest>(header.data);
  return request ? bus_.services().holder(request->service) : std::nullopt;
}

Routing MessageRouting::to_router_or_service(const HeaderView& header) const {
  if (const auto service = counting_service(header)) return to_service(service);
  if (is_own(header.subtype)) return {.to = Routing::To::router};
  const Services& services = bus_.services();
  if (const auto claimed = services.by_subtype(header.subtype)) return to_service(claimed);
  if (is_reserved(header.subtype)) return drop(Errc::no_service);
  // A request by the name of a plugged sensor means its value; commands of that name are the robot's.
  const bool value = header.type == MessageType::request && profile_.is_plugged(header.subtype);
  return to_service(services.holder(value ? kSensorBus : kModeAdapter));
}

}  // namespace trb::router
