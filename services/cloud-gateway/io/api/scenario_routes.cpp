// scenarios: stored ones, and the check of one.
#include <map>

#include "common/fleet/did_you_mean.hpp"
#include "services/cloud-gateway/core/live/page_cursor.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/conditional.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/api/scenario_body.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::uint64_t kScenarioPage = 100;

JsonObject json_info(const StoredScenario& one) {
  JsonObject out;
  out.text("id", one.id).text("name", one.scenario.name).number("tasks", one.scenario.tasks);
  out.number("version", one.version).time("changed", one.changed).text("by", one.by);
  return out;
}

/// Versions are on disk: the tag survives a restart.
ETag tag_of(const StoredScenario& one) {
  return etag_of(0, one.version);
}

void reply_missing(const CallPtr& call) {
  call->reply(problem_reply(404, "missing", "there is no such scenario", "GET /api/v1/scenarios"));
}

const StoredScenario* scenario_in_path(const Gateway& gateway, const Call& call) {
  return gateway.access.scenarios.find(call.parameter("scenario"));
}

/// By name.
void list_scenarios(const Gateway& gateway, const CallPtr& call) {
  const auto limit = call->query_number("limit", kScenarioPage, kMaxPage);
  if (!limit) return call->fail(limit.error());
  std::map<std::string, const StoredScenario*> by_name;
  for (const auto& [id, one] : gateway.access.scenarios.all()) by_name[one.scenario.name + "/" + id] = &one;
  const auto page =
      page_of(by_name, call->decision.route->path, call->query("cursor"), static_cast<std::uint32_t>(*limit));
  if (!page) return call->fail(page.error());
  JsonList items;
  for (const auto* entry : page->entries) items.add(json_info(*entry->second).done());
  call->reply(json_reply(JsonObject().raw("items", items.done()).text("next", page->next).done()));
}

void reply_scenario(const CallPtr& call, const Result<const StoredScenario*>& stored, int status) {
  if (!stored) return call->fail(stored.error());
  const StoredScenario& one = **stored;
  HttpReply out = json_reply(json_info(one).done(), status);
  out.headers.emplace_back("ETag", text_of(tag_of(one)));
  if (status == 201) out.headers.emplace_back("Location", "/api/v1/scenarios/" + one.id);
  call->reply(std::move(out));
}

void store(Gateway& gateway, const CallPtr& call) {
  auto draft = read_draft(call->request.body);
  if (!draft) return call->fail(draft.error());
  call->about = in_quotes(draft->name);
  const auto add = [&gateway, call, draft = std::move(*draft)]() mutable {
    reply_scenario(call, gateway.access.scenarios.add(std::move(draft), call->who().name, gateway.now().utc), 201);
  };
  do_once(gateway, call, "scenario " + call->about, add, Acts::here);
}

/// As `trb scenario check FILE` reads it, without a fleet.
void import_file(Gateway& gateway, const CallPtr& call) {
  ConfigFaults faults;
  op::parse_scenario(call->request.body, kScenarioFile, faults);
  if (!faults_that_stop(faults).empty()) return call->reply(faults_reply(faults_that_stop(faults)));
  store(gateway, call);
}

void show_scenario(const Gateway& gateway, const CallPtr& call) {
  const StoredScenario* one = scenario_in_path(gateway, *call);
  if (one == nullptr) return reply_missing(call);
  reply_tagged(call, tag_of(*one), json_reply(json_info(*one).raw("scenario", one->scenario.text).done()));
}

void change_scenario(Gateway& gateway, const CallPtr& call) {
  const StoredScenario* one = scenario_in_path(gateway, *call);
  if (one == nullptr) return reply_missing(call);
  if (auto refused = refused_change(*call, tag_of(*one))) return call->reply(std::move(*refused));
  auto draft = read_draft(call->request.body);
  if (!draft) return call->fail(draft.error());
  call->about = in_quotes(draft->name);
  reply_scenario(call, gateway.access.scenarios.change(one->id, std::move(*draft), call->who().name, gateway.now().utc),
                 200);
}

void delete_scenario(Gateway& gateway, const CallPtr& call) {
  const StoredScenario* one = scenario_in_path(gateway, *call);
  if (one == nullptr) return reply_missing(call);
  if (auto refused = refused_change(*call, tag_of(*one))) return call->reply(std::move(*refused));
  call->about = in_quotes(one->scenario.name);
  if (Status removed = gateway.access.scenarios.remove(one->id); !removed) return call->fail(removed.error());
  call->reply(empty_reply());
}

/// Of any name: nothing that a header or a file system would take for more than a name.
std::string file_name_of(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    out += is_plain ? c : '-';
  }
  return out + ".json";
}

void export_file(const Gateway& gateway, const CallPtr& call) {
  const StoredScenario* one = scenario_in_path(gateway, *call);
  if (one == nullptr) return reply_missing(call);
  HttpReply out = json_reply(one->scenario.text);
  out.headers.emplace_back("Content-Disposition", "attachment; filename=\"" + file_name_of(one->scenario.name) + "\"");
  reply_tagged(call, tag_of(*one), std::move(out));
}

std::string json_check(const op::ScenarioCheck& check) {
  JsonObject out;
  out.flag("good", faults_that_stop(check.faults).empty()).raw("faults", json_scenario_faults(check.faults));
  return out.raw("without_spare", json_no_spares(check.without_spare)).done();
}

void check(Gateway& gateway, const CallPtr& call) {
  const auto body = body_of(*call);
  if (!body) return call->fail(body.error());
  ConfigFaults faults;
  Scenario scenario = scenario_of(*body, faults);
  op::check_with_fleet(gateway.session, std::move(scenario), kScenarioFile, faults,
                       [call, faults](const Result<op::ScenarioCheck>& checked) {
                         if (!checked && faults.empty()) return call->fail(checked.error());
                         call->reply(json_reply(json_check(checked ? *checked : op::ScenarioCheck{faults, {}})));
                       });
}

}  // namespace

void add_scenario_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/scenarios", of_gateway(gateway, list_scenarios));
  table.add(Method::post, "/api/v1/scenarios", of_gateway(gateway, store));
  table.add(Method::post, "/api/v1/scenarios/import", of_gateway(gateway, import_file));
  table.add(Method::post, "/api/v1/scenarios/check", of_gateway(gateway, check));
  table.add(Method::get, "/api/v1/scenarios/{scenario}", of_gateway(gateway, show_scenario));
  table.add(Method::put, "/api/v1/scenarios/{scenario}", of_gateway(gateway, change_scenario));
  table.add(Method::delete_, "/api/v1/scenarios/{scenario}", of_gateway(gateway, delete_scenario));
  table.add(Method::get, "/api/v1/scenarios/{scenario}/export", of_gateway(gateway, export_file));
}

}  // namespace trb::gateway
