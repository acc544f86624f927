#include "services/router/core/local_bus.hpp"

#include <algorithm>

#include "common/security/rights.hpp"
#include "services/router/core/nack.hpp"

namespace trb::router {
namespace {

/// The maker that a record names, in this field; empty if it cannot be decoded.
template <class Body>
std::string named_by(const SignRequest& request, std::string Body::*maker) {
  const auto body = decode<Body>(request.payload.bytes);
  return body ? (*body).*maker : std::string();
}

/// Nothing: records of this kind are not signed. The head of an audit log names its node by the start of its chain.
std::optional<std::string> maker_of(const SignRequest& request, const std::string& own) {
  if (request.kind == kSignedAuditHead) return own;
  if (request.kind == kSignedResult) return named_by(request, &TaskResult::robot);
  if (request.kind == kSignedChoice) return named_by(request, &Choice::by);
  if (request.kind == kSignedRunStart) return named_by(request, &RunStart::submitter);
  if (request.kind == kSignedRunAbort) return named_by(request, &AbortOrder::by);
  if (request.kind == kSignedRunPause) return named_by(request, &PauseOrder::by);
  if (request.kind == kSignedRunEnd) return named_by(request, &RunEnd::by);
  if (request.kind == kSignedDecision) return named_by(request, &trb::Decision::by);
  return std::nullopt;
}

Member member_of(const ServiceHello& hello, std::string_view proven) {
  if (proven == kProbe) return Member::probe;
  return hello.service == visitor_of(proven) ? Member::visitor : Member::service;
}

}  // namespace

Status LocalBus::may_be(const ServiceHello& hello, std::string_view proven) const {
  if (member_of(hello, proven) != Member::service) return Done{};
  const bool named = std::find(node_.config().services.begin(), node_.config().services.end(), hello.service) !=
                     node_.config().services.end();
  if (!named || hello.service == "router") {
    return fail(Errc::not_permitted, "service '" + hello.service + "' is not in node.json", "add it to \"services\"");
  }
  if (hello.service == proven) return Done{};
  return fail(Errc::source_mismatch,
              "it comes as '" + std::string(proven) + "' and says that it is '" + hello.service + "'",
              "each service uses its own socket or key of the bus");
}

void LocalBus::on_hello(ConnectionId from, const ServiceHello& hello, std::string_view proven, Now now, Effects& out) {
  forget_silent_probes(now, out);
  const Member member = member_of(hello, proven);
  const Status good = may_be(hello, proven);
  auto slot = good ? services_.welcome(from, hello, member, now.mono) : Result<std::uint16_t>(good.error());
  if (!slot) return refuse(from, hello, slot.error(), out);
  if (member == Member::service)
    out.log(LogLevel::info, "service_up", hello.service + " (pid " + std::to_string(hello.pid) + ")");
  const RouterConfig& own = node_.config();
  messages_.send_bus(from, 1, ServiceWelcome{own.id, std::string(name_of(own.role)), *slot, own.instance, own.boot},
                     out);
  if (member == Member::service) tell_revoked(from, hello, out);
}

/// It was not there when the list came, nor when one of them was put out; and some were never met.
void LocalBus::tell_revoked(ConnectionId to, const ServiceHello& hello, Effects& out) {
  if (std::ranges::find(hello.hears, RevokedNodes::kSubtype) == hello.hears.end()) return;
  RevokedNodes revoked = trust_.revoked_nodes();
  if (!revoked.nodes.empty()) messages_.send_bus(to, 0, std::move(revoked), out);
}

void LocalBus::refuse(ConnectionId from, const ServiceHello& hello, const Error& error, Effects& out) {
  const std::string code(errc_name(error.code));
  out.count(error.code == Errc::source_mismatch ? "refused.impersonation" : "refused." + code);
  out.log(LogLevel::warning, "service_refused",
          hello.service + " (pid " + std::to_string(hello.pid) + "): " + error.what);
  const std::string hint = error.hint.empty() ? "stop the other process first: trb service list" : error.hint;
  messages_.send_bus(from, 1, Nack{code, std::string(ServiceHello::kSubtype), node_.id(), error.what, hint}, out);
}

void LocalBus::forget_silent_probes(Now now, Effects& out) {
  // Nothing reports that a probe has ended. A live one sends Hello again; to an ended one the send fails.
  std::vector<ConnectionId> silent;
  for (const auto& [id, connection] : services_.all()) {
    if (connection.member != Member::service && now.mono - connection.last_heard > node_.config().timing.lease)
      silent.push_back(id);
  }
  for (const ConnectionId id : silent) {
    services_.forget(id);
    messages_.send_bus(id, 0, HelloWanted{}, out);
  }
}

std::optional<std::string> LocalBus::on_gone(ConnectionId connection, Effects& out) {
  const Connection* known = services_.find(connection);
  if (known == nullptr) return std::nullopt;
  std::optional<std::string> service;
  if (known->member == Member::service) {
    service = known->hello.service;
    out.log(LogLevel::warning, "service_gone", *service + " (pid " + std::to_string(known->hello.pid) + ")");
  }
  services_.forget(connection);
  return service;
}

const std::vector<ConnectionId>& LocalBus::copies_for(const HeaderView& header) const {
  static const std::vector<ConnectionId> kNobody;
  if (header.type != MessageType::information || header.reply_to != 0) return kNobody;
  return services_.subscribers(header.subtype);
}

void LocalBus::notify(const Body& body, Effects& out) {
  const std::string_view subtype = subtype_of(body);
  if (const auto taker = services_.by_subtype(subtype)) messages_.send_bus(*taker, 0, body, out);
  for (const ConnectionId to : services_.subscribers(subtype)) messages_.send_bus(to, 0, body, out);
}

void LocalBus::answer(ConnectionId to, const Message& request, const Body& body, Effects& out) {
  messages_.send_bus(to, request.id, body, out);
}

void LocalBus::deny(ConnectionId to, const Message& request, const Error& error, Effects& out) {
  const std::string code(errc_name(error.code));
  out.count("refused." + code);
  if (request.type == MessageType::information || request.reply_to != 0) return;
  answer(to, request, Nack{code, request.subtype, request.target, error.what, error.hint}, out);
}

void LocalBus::nack(ConnectionId from, const HeaderView& header, Errc reason, Effects& out) {
  const bool forbidden = reason == Errc::not_permitted;
  const bool not_asked = reason == Errc::not_asked;
  out.count((forbidden || not_asked ? "refused." : "dropped.") + std::string(errc_name(reason)));
  if (const Connection* by = services_.find(from); (forbidden || not_asked) && by != nullptr) {
    const Connection* requester = not_asked ? requester_of(header.reply_to) : nullptr;
    out.log(LogLevel::warning, std::string(errc_name(reason)),
            "service '" + by->hello.service + "' (pid " + std::to_string(by->hello.pid) + ") said " +
                std::string(header.subtype) +
                (requester == nullptr ? ", which is not its word: trb help rights"
                                      : " as an answer to what '" + requester->hello.service + "' did not ask of it"));
  }
  if (!deserves_nack(header)) return;
  out.add(BusSend{from, messages_.nack(header, reason)});
}

void LocalBus::note_request(ConnectionId from, const HeaderView& header, Party whom) {
  if (header.reply_to != 0 || header.id == 0) return;
  const bool question = header.type != MessageType::information;
  if (question || deserves_nack(header)) services_.sent_by(from)->note(header.id, question, whom);
}

const Connection* LocalBus::requester_of(std::uint64_t reply_to) const {
  const auto connection = services_.by_slot(static_cast<std::uint16_t>(reply_to >> 48U));
  return connection ? services_.find(*connection) : nullptr;
}

Status LocalBus::may_sign_for(const Connection& from, const SignRequest& request) const {
  if (!may_have_signed(from.hello.service, from.member == Member::probe, request.kind) ||
      !may_sign(node_.config().role, request.kind)) {
    return fail(Errc::not_permitted,
                "service '" + from.hello.service + "' of a " + std::string(name_of(node_.config().role)) +
                    " node may not have a '" + request.kind + "' signed",
                "trb help rights says who signs what");
  }
  const auto maker = maker_of(request, node_.id());
  if (!maker) return fail(Errc::bad_value, "this version makes no records of the kind '" + request.kind + "'");
  if (*maker != node_.id())
    return fail(Errc::source_mismatch, "the record names '" + *maker + "', this node is '" + node_.id() + "'");
  return Done{};
}

void LocalBus::sign_for(ConnectionId from, const Message& message, const SignRequest& request, Effects& out) {
  const Status good = may_sign_for(*services_.find(from), request);
  if (!good) {
    out.log(LogLevel::warning, "not_signed", good.error().text());
    return deny(from, message, good.error(), out);
  }
  answer(from, message,
         sign(request.kind, node_.id(), node_.config().authority.id(), request.payload.bytes, node_.config().identity),
         out);
}

}  // namespace trb::router
