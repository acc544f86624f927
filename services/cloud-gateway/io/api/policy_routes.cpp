// policy, criteria, minimums: what resilience.json of this node says about replacing a robot.
#include <sys/stat.h>

#include <filesystem>
#include <memory>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/config/resilience_edit.hpp"
#include "common/config/resilience_file.hpp"
#include "common/operator/reload_service.hpp"
#include "common/security/keys.hpp"
#include "common/supervisor/reload_signal.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

std::string json_number(double value) {
  return dump_json(Value{value});
}

/// Exactly as it was written: a product with 1e-9 would give 120.00000000000001 for 120.
double seconds_of(Duration time) {
  return static_cast<double>(time.count()) / 1e9;
}

std::string json_policy(const ResilienceSettings& settings) {
  const ReplacementPolicy& policy = settings.policy;
  JsonObject conditions;
  conditions.raw("min_score", json_number(policy.min_score)).raw("min_lead", json_number(policy.min_lead));
  conditions.text("max_severity", name_of(policy.max_severity));
  JsonObject out;
  out.text("mode", policy.automatic ? "automatic" : "ask").text("bind", policy.asks_who_begins ? "ask" : "automatic");
  out.number("max_moves", policy.max_moves).raw("conditions", conditions.done());
  return out.raw("expires_s", json_number(seconds_of(settings.expires))).done();
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

/// One change at a time: each is answered once it is in force.
struct Changing {
  bool is_under_way = false;
};

struct PartRoute {
  std::string_view path;
  ResiliencePart part{};
  ShownPart shown = nullptr;
};

/// Where it really is, if the node's folder has a link.
std::string file_of(const Gateway& gateway) {
  const std::filesystem::path path = gateway.node_dir + "/resilience.json";
  std::error_code missing;
  const std::filesystem::path real = std::filesystem::canonical(path, missing);
  return (missing ? path : real).string();
}

HttpReply faulty_file(const ConfigFaults& faults) {
  return problem_reply(500, "file_faulty", "resilience.json: " + faults.front().key + ": " + faults.front().what,
                       "trb check with this node's folder lists all faults");
}

/// Read anew for each request: an operator may have changed the file.
std::optional<std::string> shown_now(const Gateway& gateway, ShownPart shown, ConfigFaults& faults) {
  const ResilienceSettings settings = read_resilience_file(gateway.node_dir, faults);
  return faults.empty() ? std::optional(shown(settings)) : std::nullopt;
}

ETag tag_of(const std::string& json) {
  return {to_hex(digest(json))};
}

void reply_settings(const Gateway& gateway, const CallPtr& call, ShownPart shown) {
  ConfigFaults faults;
  auto json = shown_now(gateway, shown, faults);
  if (!json) return call->reply(faulty_file(faults));
  const ETag tag = tag_of(*json);
  reply_tagged(call, tag, json_reply(std::move(*json)));
}

/// With the mode of the old file; the gateway's other files belong to its user alone.
Status write_settings(const std::string& path, const std::string& text) {
  struct stat now {};
  constexpr unsigned kOwn = 0600;
  constexpr unsigned kBits = 0777;
  return write_file(path, text, ::stat(path.c_str(), &now) == 0 ? now.st_mode & kBits : kOwn);
}

/// 503: the file is new, the service is not.
HttpReply not_in_force(const Error& why) {
  return problem_reply(
      503, "not_in_force", "resilience.json is written, but not in force: " + why.what,
      (why.hint.empty() ? "" : why.hint + "; ") + "repeat the request with the new ETag, or trb reload");
}

void put_in_force(Gateway& gateway, const CallPtr& call, ShownPart shown, const std::shared_ptr<Changing>& changing) {
  changing->is_under_way = true;
  op::ReloadService order{.service = "resilience", .ask = [](std::uint32_t pid) {
                            return supervisor::ask_to_reload(static_cast<pid_t>(pid), "resilience");
                          }};
  op::reload_service(gateway.session, std::move(order), [&gateway, call, shown, changing](const auto& up) {
    changing->is_under_way = false;
    if (!up) return call->reply(not_in_force(up.error()));
    ConfigFaults faults;
    auto json = shown_now(gateway, shown, faults);
    if (!json) return call->reply(faulty_file(faults));
    HttpReply out = json_reply(std::move(*json));
    out.headers.emplace_back("ETag", text_of(tag_of(*out.body)));
    call->reply(std::move(out));
  });
}

/// The file's new text; nothing: the call is answered.
std::optional<std::string> text_after(const std::string& path, const CallPtr& call, ResiliencePart part) {
  const auto change = body_of(*call);
  if (!change) return call->fail(change.error()), std::nullopt;
  const auto old = read_file(path);
  if (!old && old.error().code != Errc::missing) return call->fail(old.error()), std::nullopt;
  ConfigFaults faults;
  auto out = edit_resilience(old ? *old : std::string(), part, *change, faults);
  if (!out) call->reply(problem_reply(problem_of(faults)));
  return out;
}

void change_settings(Gateway& gateway, const CallPtr& call, const PartRoute& route,
                     const std::shared_ptr<Changing>& changing) {
  ConfigFaults faults;
  const auto json = shown_now(gateway, route.shown, faults);
  if (!json) return call->reply(faulty_file(faults));
  if (auto refused = refused_change(*call, tag_of(*json))) return call->reply(std::move(*refused));
  if (changing->is_under_way) {
    return call->reply(
        problem_reply(409, "under_way", "another change is being put in force", "try again in a second"));
  }
  const std::string path = file_of(gateway);
  const auto text = text_after(path, call, route.part);
  if (!text) return;
  // On disk before anything is changed.
  note_begin(gateway, *call);
  if (Status noted = gateway.commit(); !noted) return fail_unwritten(gateway, *call, noted.error());
  if (Status written = write_settings(path, *text); !written) return call->fail(written.error());
  put_in_force(gateway, call, route.shown, changing);
}

}  // namespace

void add_policy_routes(Gateway& gateway, HandlerTable& table) {
  const auto changing = std::make_shared<Changing>();
  for (const PartRoute& route : {PartRoute{"/api/v1/policy", ResiliencePart::policy, json_policy},
                                 PartRoute{"/api/v1/criteria", ResiliencePart::criteria, json_criteria},
                                 PartRoute{"/api/v1/minimums", ResiliencePart::minimums, json_minimums}}) {
    table.add(Method::get, route.path,
              [&gateway, route](const CallPtr& call) { reply_settings(gateway, call, route.shown); });
    table.add(Method::put, route.path,
              [&gateway, route, changing](const CallPtr& call) { change_settings(gateway, call, route, changing); });
  }
}

}  // namespace trb::gateway
