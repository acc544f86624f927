// policy, criteria, minimums: what resilience.json of this node says about replacing a robot.
#include "common/base/hex.hpp"
#include "common/config/resilience_file.hpp"
#include "common/security/keys.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

std::string json_number(double value) {
  return dump_json(Value{value});
}

std::string json_policy(const ResilienceSettings& settings) {
  const ReplacementPolicy& policy = settings.policy;
  JsonObject conditions;
  conditions.raw("min_score", json_number(policy.min_score)).raw("min_lead", json_number(policy.min_lead));
  conditions.text("max_severity", name_of(policy.max_severity));
  JsonObject out;
  out.text("mode", policy.automatic ? "automatic" : "ask").text("bind", policy.asks_who_begins ? "ask" : "automatic");
  out.number("max_moves", policy.max_moves).raw("conditions", conditions.done());
  return out.raw("expires_s", json_number(to_seconds(settings.expires))).done();
}

void add_bounds(const ReplacementCriterion& one, JsonObject& out) {
  if (one.at_least) out.raw("at_least", json_number(*one.at_least));
  if (one.at_most) out.raw("at_most", json_number(*one.at_most));
}

/// Where the value of an operator's own criterion comes from; battery, distance and availability have their own.
void add_source(const ReplacementCriterion& one, JsonObject& out) {
  if (one.from <= CriterionSource::availability) return;
  out.text("from", one.from == CriterionSource::robot         ? "robot"
                   : one.from == CriterionSource::description ? "description"
                                                              : "sensor");
  out.text("value", one.value).text("unit", one.unit);
}

std::string json_criterion(const ReplacementCriterion& one) {
  JsonObject out;
  out.raw("weight", json_number(one.weight)).raw("best", json_number(one.best)).raw("worst", json_number(one.worst));
  add_source(one, out);
  add_bounds(one, out);
  if (one.capabilities.empty()) return out.done();
  JsonList capabilities;
  for (const std::string& name : one.capabilities) capabilities.add(json_quoted(name));
  return out.raw("capabilities", capabilities.done()).done();
}

/// Judgments become the weights that follow from them.
std::string json_criteria(const ResilienceSettings& settings) {
  JsonObject all;
  for (const ReplacementCriterion& one : settings.criteria) all.raw(one.name, json_criterion(one));
  return JsonObject().raw("criteria", all.done()).done();
}

std::string json_minimums(const ResilienceSettings& settings) {
  JsonObject out;
  for (const ReplacementCriterion& one : settings.criteria) {
    if (!one.at_least && !one.at_most) continue;
    JsonObject bounds;
    add_bounds(one, bounds);
    out.raw(one.name, bounds.done());
  }
  return out.done();
}

using ShownPart = std::string (*)(const ResilienceSettings&);

/// Read anew for each request: an operator may have changed the file.
void reply_settings(const Gateway& gateway, const CallPtr& call, ShownPart shown) {
  ConfigFaults faults;
  const ResilienceSettings settings = read_resilience_file(gateway.node_dir, faults);
  if (!faults.empty()) {
    return call->reply(problem_reply(500, "file_faulty",
                                     "resilience.json: " + faults.front().key + ": " + faults.front().what,
                                     "trb check with this node's folder lists all faults"));
  }
  std::string json = shown(settings);
  const ETag tag{to_hex(digest(json))};
  reply_tagged(call, tag, json_reply(std::move(json)));
}

}  // namespace

void add_policy_routes(Gateway& gateway, HandlerTable& table) {
  const auto add = [&](std::string_view path, ShownPart shown) {
    table.add(Method::get, path, [&gateway, shown](const CallPtr& call) { reply_settings(gateway, call, shown); });
  };
  add("/api/v1/policy", json_policy);
  add("/api/v1/criteria", json_criteria);
  add("/api/v1/minimums", json_minimums);
}

}  // namespace trb::gateway
