// The node's own bus: services come and go, ask the router, have records signed.
#include <algorithm>

#include "common/security/rights.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

/// A message of this router's own. What its hearer would have to refuse is not made; who waits for it is told so.
std::optional<Message> RouterCore::make_own(const std::string& target, std::uint64_t reply_to, const Body& body,
                                            Effects& out) {
  auto data = pack_body(body);
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(body);
  message.source = config_.id;
  message.target = target;
  message.id = ++message_count_;
  message.reply_to = reply_to;
  if (data) {
    message.data = std::move(*data);
    return message;
  }
  const Error& why = data.error();
  out.count("dropped." + std::string(errc_name(why.code)));
  out.log(LogLevel::error, "not_sent", message.subtype + " for '" + target + "': " + why.text());
  if (reply_to == 0) return std::nullopt;
  message.data = encode(Nack{std::string(errc_name(why.code)), message.subtype, target, why.what, why.cure});
  message.subtype = Nack::kSubtype;
  return message;
}

void RouterCore::bus_send(ConnectionId to, std::uint64_t reply_to, const Body& body, Effects& out) {
  if (auto message = make_own(config_.id, reply_to, body, out)) out.add(BusSend{to, std::move(*message)});
}

namespace {

/// As much of both as a note may be long; no letter is cut in two.
std::string join_notes(const std::string& first, const std::string& second) {
  std::string out = first + (first.empty() || second.empty() ? "" : "; ") + second;
  auto end = std::min<std::size_t>(out.size(), kDefaultMaxSize);
  while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xc0U) == 0x80) --end;
  return out.substr(0, end);
}

}  // namespace

Status RouterCore::may_be(const ServiceHello& hello, std::string_view proven) const {
  if (proven == kProbe) return Done{};
  const bool named =
      std::find(config_.services.begin(), config_.services.end(), hello.service) != config_.services.end();
  if (!named || hello.service == "router") {
    return fail(Errc::not_permitted, "service '" + hello.service + "' is not in node.json", "add it to \"services\"");
  }
  if (hello.service == proven) return Done{};
  return fail(Errc::source_mismatch,
              "it comes as '" + std::string(proven) + "' and says that it is '" + hello.service + "'",
              "each service uses its own socket or key of the bus");
}

void RouterCore::on_service_hello(ConnectionId from, const ServiceHello& hello, std::string_view proven, Now now,
                                  Effects& out) {
  forget_silent_probes(now, out);
  const bool probe = proven == kProbe;
  const Status good = may_be(hello, proven);
  auto slot = good ? services_.welcome(from, hello, probe, now.mono) : Result<std::uint16_t>(good.error());
  if (!slot) {
    const bool impersonation = slot.error().code == Errc::source_mismatch;
    out.count(impersonation ? "refused.impersonation" : "refused." + std::string(errc_name(slot.error().code)));
    out.log(LogLevel::warning, "service_refused",
            hello.service + " (pid " + std::to_string(hello.pid) + "): " + slot.error().what);
    const Nack nack{std::string(errc_name(slot.error().code)), std::string(ServiceHello::kSubtype), config_.id,
                    slot.error().what,
                    slot.error().cure.empty() ? "stop the other process first: trb service list" : slot.error().cure};
    bus_send(from, 1, nack, out);
    return;
  }
  if (!probe) out.log(LogLevel::info, "service_up", hello.service + " (pid " + std::to_string(hello.pid) + ")");
  const ServiceWelcome welcome{config_.id, std::string(name_of(config_.role)), *slot, config_.instance, config_.boot};
  bus_send(from, 1, welcome, out);
}

void RouterCore::forget_silent_probes(Now now, Effects& out) {
  // Nobody tells when a probe ends. One that lives says hello again; to one that is gone the send fails.
  std::vector<ConnectionId> silent;
  for (const auto& [id, connection] : services_.all()) {
    if (connection.probe && now.mono - connection.last_heard > config_.timing.lease) silent.push_back(id);
  }
  for (const ConnectionId id : silent) {
    services_.forget(id);
    bus_send(id, 0, HelloWanted{}, out);
  }
}

void RouterCore::on_connection_gone(ConnectionId connection, Now now, Effects& out) {
  const Connection* known = services_.find(connection);
  if (known == nullptr) return;
  if (!known->probe)
    out.log(LogLevel::warning, "service_gone",
            known->hello.service + " (pid " + std::to_string(known->hello.pid) + ")");
  sensor_bus_gone(*known, now);
  services_.forget(connection);
}

void RouterCore::on_bus_message(ConnectionId from, const Message& message, Now now, Effects& out) {
  const Connection* connection = services_.find(from);
  if (connection == nullptr) return;
  services_.heard(from, now.mono);
  auto body = decode_body(message.subtype, message.data);
  if (!body) return deny(from, message, body.error(), out);
  if (holds_alternative<ServiceAlive>(*body)) {
    bus_send(from, message.id, ServiceAliveSeen{config_.instance}, out);
  } else if (const auto* request = get_if<SignRequest>(&*body)) {
    sign_for(from, message, *request, out);
  } else if (const auto* news = get_if<FleetNews>(&*body)) {
    answer_news(from, message, *news, now, out);
  } else if (const auto* profile = get_if<NodeProfile>(&*body)) {
    if (connection->hello.service != "mode-adapter" || connection->probe) return;
    on_robot_profile(*profile, now, out);
  } else if (const auto* sensors = get_if<NodeSensors>(&*body)) {
    if (connection->hello.service == "sensor-bus" && !connection->probe) on_node_sensors(*sensors, out);
  } else if (auto reply = answer_to(message, now)) {
    answer(from, message, *reply, out);
  } else {
    deny(from, message, reply.error(), out);
  }
}

/// A table costs a question of a hundred bytes: who asks without end would have this node work and speak for him alone.
/// An echo is as long as its question.
Result<Body> RouterCore::answer_peer(Peer& peer, const Message& message, Now now) const {
  const bool table = message.type == MessageType::request && message.subtype != EchoRequest::kSubtype;
  if (table && !peer.answers.has_room(now.mono)) {
    return fail(Errc::queue_full,
                message.subtype + ": in this second '" + peer.id + "' was told " + std::to_string(kAnsweredOfOne) +
                    " bytes already",
                "ask less often");
  }
  return answer_to(message, now);
}

Result<Body> RouterCore::answer_to(const Message& message, Now now) const {
  if (message.type == MessageType::request) {
    if (message.subtype == RouteListRequest::kSubtype) {
      auto asked = decode<RouteListRequest>(message.data);
      if (!asked) return asked.error();
      return Body{route_table(now, asked->after)};
    }
    if (message.subtype == ServiceListRequest::kSubtype) return Body{service_table(now)};
    if (message.subtype == RouterCountersRequest::kSubtype) return Body{counters()};
    if (message.subtype == LinkTroublesRequest::kSubtype) return Body{troubles_.table(config_.id, now.mono)};
    if (message.subtype == EchoRequest::kSubtype) {
      auto asked = decode<EchoRequest>(message.data);
      if (!asked) return asked.error();
      return Body{Echo{std::move(asked->pad)}};
    }
  }
  return fail(Errc::bad_value, message.subtype + " is not for a router in this way");
}

void RouterCore::answer(ConnectionId to, const Message& asked, const Body& body, Effects& out) {
  bus_send(to, asked.id, body, out);
}

void RouterCore::deny(ConnectionId to, const Message& asked, const Error& error, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  if (asked.type == MessageType::information || asked.reply_to != 0) return;
  answer(to, asked, Nack{std::string(errc_name(error.code)), asked.subtype, asked.target, error.what, error.cure}, out);
}

Status RouterCore::may_sign_for(const Connection& from, const SignRequest& request) const {
  if (!may_have_signed(from.hello.service, from.probe, request.kind) || !may_sign(config_.role, request.kind)) {
    return fail(Errc::not_permitted,
                "service '" + from.hello.service + "' of a " + std::string(name_of(config_.role)) +
                    " node may not have a '" + request.kind + "' signed",
                "trb help rights says who signs what");
  }
  std::string maker;
  if (request.kind == kSignedResult) {
    if (auto body = decode<TaskResult>(request.payload.bytes)) maker = body->robot;
  } else if (request.kind == kSignedChoice) {
    if (auto body = decode<Choice>(request.payload.bytes)) maker = body->by;
  } else if (request.kind == kSignedRunStart) {
    if (auto body = decode<RunStart>(request.payload.bytes)) maker = body->submitter;
  } else if (request.kind == kSignedRunAbort) {
    if (auto body = decode<AbortOrder>(request.payload.bytes)) maker = body->by;
  } else if (request.kind == kSignedRunPause) {
    if (auto body = decode<PauseOrder>(request.payload.bytes)) maker = body->by;
  } else if (request.kind == kSignedRunEnd) {
    if (auto body = decode<RunEnd>(request.payload.bytes)) maker = body->by;
  } else if (request.kind == kSignedDecision) {
    if (auto body = decode<trb::Decision>(request.payload.bytes)) maker = body->by;
  } else {
    return fail(Errc::bad_value, "this version makes no records of the kind '" + request.kind + "'");
  }
  if (maker != config_.id)
    return fail(Errc::source_mismatch, "the record names '" + maker + "', this node is '" + config_.id + "'");
  return Done{};
}

void RouterCore::sign_for(ConnectionId from, const Message& message, const SignRequest& request, Effects& out) {
  const Status good = may_sign_for(*services_.find(from), request);
  if (!good) {
    out.log(LogLevel::warning, "not_signed", good.error().text());
    return deny(from, message, good.error(), out);
  }
  answer(from, message, sign(request.kind, config_.id, config_.authority.id(), request.payload.bytes, config_.identity),
         out);
}

ServiceTable RouterCore::service_table(Now now) const {
  ServiceTable table{config_.id, {}};
  table.services.push_back({"router",
                            "up",
                            config_.pid,
                            config_.instance,
                            config_.version,
                            to_seconds(now.mono - started_),
                            0,
                            {},
                            join_notes(own_note(now), unstored_.note())});
  for (const std::string& name : config_.services) {
    if (name == "router") continue;
    ServiceEntry entry{name, "down", 0, 0, "", 0, 0, {}, {}};
    if (const auto holder = services_.holder(name)) {
      const Connection& connection = *services_.find(*holder);
      const Duration quiet = now.mono - connection.last_heard;
      entry = {name,
               quiet > config_.timing.service_silent ? "silent" : "up",
               connection.hello.pid,
               connection.hello.instance,
               connection.hello.version,
               to_seconds(now.mono - connection.since),
               to_seconds(quiet),
               connection.hello.subtypes,
               {}};
    }
    table.services.push_back(std::move(entry));
  }
  return table;
}

Counters RouterCore::counters() const {
  Counters out{config_.id, "router", {}};
  for (const auto& [name, value] : counts_) out.values.push_back({name, value});
  return out;
}

void RouterCore::tell_services(Body body, Effects& out) {
  const std::string_view subtype = subtype_of(body);
  if (const auto taker = services_.by_subtype(subtype)) {
    bus_send(*taker, 0, body, out);
  }
  for (const ConnectionId hearer : services_.hearers(subtype)) {
    bus_send(hearer, 0, body, out);
  }
}

std::vector<ConnectionId> RouterCore::hearers_of(const HeaderView& header) const {
  if (header.type != MessageType::information || header.reply_to != 0) return {};
  return services_.hearers(header.subtype);
}

}  // namespace trb::router
