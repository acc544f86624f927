#include "services/cloud-gateway/io/api/once.hpp"

#include <algorithm>

#include "common/log/log.hpp"
#include "common/security/keys.hpp"
#include "services/cloud-gateway/core/live/etag.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

Bytes digest_of(const HttpRequest& request) {
  return purpose_digest("idempotency", request.method + " " + request.target + "\n" + request.body);
}

constexpr int kNoContent = 204;
constexpr std::string_view kScenariosPath = "/api/v1/scenarios/";

/// For an answer whose body was too long to be kept.
HttpReply stand_in(int status) {
  const std::string said =
      "the first request with this Idempotency-Key was answered, and its answer is too long to be kept";
  if (status >= 400) return problem_reply(status, "not_kept", said, "send it with a new key to see why it was refused");
  return json_reply(JsonObject().text("not_kept", said).done(), status);
}

/// A route that makes something, and where its answer says what.
struct Made {
  std::string_view route;
  std::string_view under;   ///< what is made is read here
  std::string_view member;  ///< of the answer: its id
};
constexpr Made kMade[] = {{"/api/v1/runs", "/api/v1/runs/", "run"},
                          {"/api/v1/scenarios", kScenariosPath, "id"},
                          {"/api/v1/scenarios/import", kScenariosPath, "id"},
                          {"/api/v1/simulations", "/api/v1/simulations/", "id"}};

/// Location and ETag of the first answer: both follow from its body, which alone is kept.
void add_kept_headers(const Route& route, const Bytes& body, HttpReply& out) {
  const auto* made = std::ranges::find(kMade, route.path, &Made::route);
  const auto json = parse_json(body);
  const Value* id = made == std::end(kMade) || !json ? nullptr : json->find(made->member);
  if (id == nullptr || !id->is_text()) return;
  out.headers.emplace_back("Location", std::string(made->under) + id->text());
  const Value* version = made->under == kScenariosPath ? json->find("version") : nullptr;
  if (version == nullptr || !version->is_integer()) return;
  out.headers.emplace_back("ETag", text_of(etag_of(0, static_cast<std::uint64_t>(version->integer()))));
}

HttpReply kept_reply(const Route& route, const StoredAnswer& stored) {
  if (stored.status == kNoContent) return empty_reply();
  if (stored.body.empty()) return stand_in(stored.status);
  HttpReply out = json_reply(stored.body, stored.status);
  if (stored.status >= 400) out.content_type = "application/problem+json";
  if (stored.status < 400) add_kept_headers(route, stored.body, out);
  return out;
}

void reply_again(Call& call, const StoredAnswer& stored, const Again& again) {
  call.is_replay = true;
  const bool is_done_without_body = stored.body.empty() && stored.status < 400 && stored.status != kNoContent;
  return is_done_without_body && again ? again() : call.reply(kept_reply(*call.decision.route, stored));
}

void reply_busy(Call& call, Duration retry_after) {
  HttpReply out = problem_reply(409, "under_way", "the first request with this Idempotency-Key is under way",
                                "repeat it with the same key");
  const auto s = std::chrono::duration_cast<std::chrono::seconds>(retry_after).count();
  out.headers.emplace_back("Retry-After", std::to_string(std::max<std::int64_t>(s, 1)));
  call.reply(std::move(out));
}

AuditRecord begin_of(const Gateway& gateway, const Call& call) {
  AuditRecord record = record_of(call.decision, call.who().name, call.request.source, call.about, gateway.now().utc);
  record.outcome = "begins";
  return record;
}

/// With what was noted. Of an intent that another gateway was quicker with the answer is that one's.
Status store_intent(Gateway& gateway, Call& call, const std::optional<StoredRequest>& intent) {
  if (intent) gateway.access.keep(*intent);
  Status written = gateway.commit();
  call.once = intent && written ? std::optional(intent->key) : std::nullopt;
  if (intent && !written) gateway.access.requests.release(intent->key);
  return written;
}

/// Robots first: a database may take seconds. What is not written is owed, for they were told all the same.
void stop_once(Gateway& gateway, Call& call, const std::optional<StoredRequest>& intent,
               const std::function<void()>& act) {
  if (intent) call.once = intent->key;
  act();
  if (call.is_answered()) return;
  AuditRecord begin = begin_of(gateway, call);
  gateway.access.note(begin);
  if (!store_intent(gateway, call, intent)) static_cast<void>(put_off(gateway, std::move(begin)));
}

/// An answer may say that some robot was not reached, or somebody has released one since; and done twice, it is a stop.
bool is_stop_again(const Call& call, const Result<Idempotency::Begun>& begun) {
  return is_stop(*call.decision.route) && (!begun || !std::holds_alternative<Idempotency::Act>(*begun));
}

StoredAnswer answer_of(const HttpReply& reply) {
  return {static_cast<std::uint16_t>(reply.status), reply.body == nullptr ? Bytes() : *reply.body};
}

}  // namespace

void do_once(Gateway& gateway, const CallPtr& call, std::string effect, const std::function<void()>& act, Acts acts,
             const Again& again) {
  std::optional<StoredRequest> intent;
  if (call->request.idempotency_key) {
    const RequestKey key{call->who().name, *call->request.idempotency_key};
    auto begun = gateway.access.requests.begin(key, digest_of(call->request), std::move(effect), gateway.steady());
    if (is_stop_again(*call, begun)) return stop_once(gateway, *call, std::nullopt, act);
    if (!begun) return call->fail(begun.error());
    if (auto* stored = std::get_if<StoredAnswer>(&*begun)) return reply_again(*call, *stored, again);
    if (auto* wait = std::get_if<Idempotency::Wait>(&*begun)) return reply_busy(*call, wait->retry_after);
    intent = std::move(std::get<Idempotency::Act>(*begun).store);
  }
  if (is_stop(*call->decision.route)) return stop_once(gateway, *call, intent, act);
  if (acts == Acts::here && !intent) return act();
  if (acts == Acts::in_fleet) note_begin(gateway, *call);
  if (Status written = store_intent(gateway, *call, intent); !written)
    return fail_unwritten(gateway, *call, written.error());
  act();
}

void order_once(Gateway& gateway, const CallPtr& call, std::string_view of, const std::function<void()>& act,
                const Again& again) {
  do_once(gateway, call, std::string(call->decision.route->path) + " " + call->parameter(of), act, Acts::in_fleet,
          again);
}

void note_begin(Gateway& gateway, Call& call) {
  call.has_begun = true;
  gateway.access.note(begin_of(gateway, call));
}

void keep_answer(Gateway& gateway, const Call& call, const HttpReply& reply) {
  if (!call.once) return;
  if (call.is_not_done) {
    if (gateway.access.requests.release(*call.once)) gateway.access.drop(*call.once);
    return;
  }
  if (auto stored = gateway.access.requests.finish(*call.once, answer_of(reply)))
    gateway.access.keep(std::move(*stored));
}

Status settle_unsure(Access& access, UtcTime now, std::optional<UtcTime> before) {
  for (const StoredRequest& one : access.requests.unsure(before)) {
    const HttpReply reply = problem_reply(503, "not_confirmed", "the gateway ended before it was known: " + one.effect,
                                          "look whether it was done, then use a new Idempotency-Key");
    log_event(Level::warning, "not_confirmed", one.key.user + ": " + one.effect);
    if (auto stored = access.requests.finish(one.key, answer_of(reply))) access.settle(std::move(*stored), now);
  }
  return access.commit();
}

}  // namespace trb::gateway
