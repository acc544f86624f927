#include "services/cloud-gateway/io/api/api.hpp"

#include <algorithm>

#include "services/cloud-gateway/io/api/gzip.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/live_socket.hpp"

namespace trb::gateway {
namespace {

std::string allow_of(const std::vector<Method>& methods) {
  std::string out;
  for (const Method method : methods) out += (out.empty() ? "" : ", ") + std::string(name_of(method));
  return out;
}

/// The media type alone counts, in any case; what follows it are parameters (RFC 9110, 8.3.1).
bool is_json(const HttpRequest& request) {
  if (!request.content_type) return false;
  std::string_view type = std::string_view(*request.content_type).substr(0, request.content_type->find(';'));
  while (type.ends_with(' ') || type.ends_with('\t')) type.remove_suffix(1);
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(type, std::string_view("application/json"), {}, lower);
}

/// What somebody did, or was refused; nothing: it changes nothing, or nobody is known.
std::optional<AuditRecord> audit_of(const RequestDecision& decision, const std::string& who, const std::string& source,
                                    int status, const std::string& about, const std::string& outcome, UtcTime now) {
  if (decision.route == nullptr || decision.route->effect != Effect::changes || who.empty()) return std::nullopt;
  AuditRecord out = record_of(decision, who, source, about, now);
  out.outcome = status < 400 ? outcome : "refused: " + std::to_string(status);
  return out;
}

/// What strangers can have refused as often as they like: a sign-in, and what they may not do.
bool is_anybodys(const RequestDecision& decision, int status) {
  if (status < 400) return false;
  return decision.verdict != RequestVerdict::allowed || decision.route->path == "/api/v1/session";
}

/// Pages and health, for which nobody has to be known.
bool needs_nobody(const RequestDecision& decision) {
  return decision.route != nullptr && decision.route->least == Least::anyone && decision.route->effect == Effect::reads;
}

HttpReply no_database_reply() {
  HttpReply out = problem_reply(503, "no_database", "the gateway's database does not answer",
                                "it is called again by itself; an admin sees the reason in the gateway's log");
  out.headers.emplace_back("Retry-After", "1");
  return out;
}

HttpReply refuse(const RequestDecision& decision) {
  HttpReply out = problem_reply(status_of(decision.verdict), name_of(decision.verdict),
                                "the request was refused: " + std::string(name_of(decision.verdict)), decision.hint);
  if (!decision.allow.empty()) out.headers.emplace_back("Allow", allow_of(decision.allow));
  if (decision.verdict == RequestVerdict::not_signed_in) out.headers.emplace_back("WWW-Authenticate", "Bearer");
  return out;
}

/// Who signs in may stop robots, and who leaves is gone: neither waits for its record.
bool is_session(const Route& route) {
  return route.effect == Effect::changes && route.path == "/api/v1/session";
}

/// While nothing can be put on record: what must be on it first. It leaves no record either.
std::optional<HttpReply> refuse_unrecorded(const Gateway& gateway, const RequestDecision& decision) {
  const auto& why = gateway.access.unwritten();
  if (!why || decision.verdict != RequestVerdict::allowed || decision.route->effect != Effect::changes ||
      is_stop(*decision.route))
    return std::nullopt;
  if (is_session(*decision.route) && gateway.access.may_owe_lesser()) return std::nullopt;
  return unwritten_reply(gateway, *why);
}

}  // namespace

const Handler* HandlerTable::find(const Route& route) const {
  const auto at = rows_.find({route.method, route.path});
  return at == rows_.end() ? nullptr : &at->second;
}

bool is_still_allowed(Gateway& gateway, const CallPtr& call) {
  if (!refresh(gateway)) {
    call->reply(no_database_reply());
    return false;
  }
  const RequestDecision decision = gateway.access.check.check(call->request.head(), gateway.steady());
  if (decision.verdict != RequestVerdict::allowed) call->reply(refuse(decision));
  // The disk may be full only since a password is being hashed.
  if (auto refused = refuse_unrecorded(gateway, decision)) call->reply(std::move(*refused));
  return !call->is_answered();
}

Api::Api(Gateway& gateway) : gateway_(gateway) {
  add_status_routes(gateway, table_);
  add_session_routes(gateway, table_);
  add_user_routes(gateway, table_);
  add_token_routes(gateway, table_);
  add_fleet_routes(gateway, table_);
  add_robot_routes(gateway, table_);
  add_preflight_route(gateway, table_);
  add_rank_routes(gateway, table_);
  add_scenario_routes(gateway, table_);
  add_simulation_routes(gateway, table_);
  add_run_routes(gateway, table_);
  add_alert_routes(gateway, table_);
  add_message_routes(gateway, table_);
  add_history_routes(gateway, table_);
  add_node_routes(gateway, table_);
  add_task_routes(gateway, table_);
  add_audit_routes(gateway, table_);
  add_policy_routes(gateway, table_);
  add_page_routes(table_);
}

/// On what is in the database; of a stop on what was known of it last, so that it waits for nothing. Nullopt: the
/// database does not answer.
std::optional<RequestDecision> Api::decide(const HttpRequest& request) {
  const auto known = [&] { return gateway_.access.check.check(request.head(), gateway_.steady()); };
  RequestDecision decision = known();
  if (!gateway_.db.is_shared()) return decision;
  if (decision.verdict == RequestVerdict::allowed && is_stop(*decision.route)) return decision;
  const Status fresh = refresh(gateway_);
  decision = known();
  if (!fresh && !needs_nobody(decision)) return std::nullopt;
  return decision;
}

std::optional<HttpReply> Api::before_body(const HttpRequest& request) {
  const auto decision = decide(request);
  if (!decision) return counted(no_database_reply());
  if (auto refused = refuse_unrecorded(gateway_, *decision)) return counted(std::move(*refused));
  if (decision->verdict == RequestVerdict::allowed) return std::nullopt;
  return on_record(*decision, decision->who.name, request.source, refuse(*decision));
}

void Api::on_request(HttpRequest request, Reply reply) {
  auto decision = decide(request);
  if (!decision) return reply(counted(no_database_reply()));
  if (auto refused = refuse_unrecorded(gateway_, *decision)) return reply(counted(std::move(*refused)));
  const auto call = std::make_shared<Call>(std::move(request), std::move(*decision),
                                           [this, reply = std::move(reply), open = open_calls_](
                                               const Call& of, HttpReply with) { end(of, std::move(with), reply); });
  if (call->decision.verdict != RequestVerdict::allowed) return call->reply(refuse(call->decision));
  if (!call->request.body.empty() && !is_json(call->request)) {
    return call->reply(problem_reply(415, "media_type", "the body's Content-Type is not application/json",
                                     "send Content-Type: application/json"));
  }
  const Handler* handler = table_.find(*call->decision.route);
  if (handler != nullptr) return (*handler)(call);
  call->reply(problem_reply(501, "not_built", std::string(call->decision.route->path) + " is not built yet",
                            "the command line has it: trb help"));
}

void Api::end(const Call& call, HttpReply reply, const Reply& send) {
  keep_answer(gateway_, call, reply);
  const std::string& who = call.actor.empty() ? call.who().name : call.actor;
  HttpReply out =
      on_record(call.decision, who, call.request.source, std::move(reply), call.about, call.outcome, call.has_begun);
  if (call.decision.route != nullptr) zip(*call.decision.route, call.request.accepts_gzip, out);
  send(std::move(out));
}

HttpReply Api::on_record(const RequestDecision& decision, const std::string& who, const std::string& source,
                         HttpReply reply, const std::string& about, const std::string& outcome, bool has_begun) {
  auto record = audit_of(decision, who, source, reply.status, about, outcome, gateway_.now().utc);
  if (record && is_anybodys(decision, reply.status) && !gateway_.access.refusals.is_recorded(*record, gateway_.now()))
    record.reset();
  if (record) gateway_.access.note(*record);
  if (Status written = gateway_.commit(); !written)
    reply = unrecorded(decision, std::move(record), std::move(reply), written.error(), has_begun);
  return counted(std::move(reply));
}

/// Its record follows as soon as it can, if it was done all the same: the answer says so. So does the one of a refusal
/// on a full disk, if it leaves room for those.
HttpReply Api::unrecorded(const RequestDecision& decision, std::optional<AuditRecord> record, HttpReply reply,
                          const Error& why, bool has_begun) {
  const bool is_full = gateway_.access.unwritten().has_value();
  if (is_full && record && reply.status >= 400) {
    static_cast<void>(gateway_.access.owe_lesser(std::move(*record)));
    return reply;
  }
  const bool is_done =
      record && reply.status < 400 && (is_stop(*decision.route) || (is_full && is_session(*decision.route)));
  if (!is_done) return unwritten_reply(gateway_, why, has_begun);
  reply.headers.emplace_back("Audit-Record", put_off(gateway_, std::move(*record)) ? "owed" : "lost");
  return reply;
}

HttpReply Api::counted(HttpReply reply) {
  ++gateway_.counts.replies[reply.status];
  return reply;
}

std::variant<std::shared_ptr<WebSocketIn>, HttpReply> Api::on_upgrade(const HttpRequest& request) {
  if (!refresh(gateway_)) return counted(no_database_reply());
  const RequestDecision decision = gateway_.access.check.check(request.head(), gateway_.steady());
  if (decision.verdict != RequestVerdict::allowed) return refuse(decision);
  if (decision.route->effect != Effect::upgrades) {
    return problem_reply(400, "no_websocket", "this route is no WebSocket", "/api/v1/live is one");
  }
  auto opened = LiveSocket::open(gateway_, request, decision.who.name);
  if (!opened) return problem_reply(opened.error());
  return std::shared_ptr<WebSocketIn>(std::move(*opened));
}

HttpReply Api::refusal(int status, const std::string& code, const std::string& detail, const std::string& hint) {
  ++gateway_.counts.replies[status];
  return problem_reply(status, code, detail, hint);
}

}  // namespace trb::gateway
