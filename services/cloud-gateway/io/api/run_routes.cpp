// runs, archive.
#include "common/operator/abort_run.hpp"
#include "common/operator/pause_run.hpp"
#include "common/operator/plan_run.hpp"
#include "common/operator/run_records.hpp"
#include "common/operator/submit_run.hpp"
#include "common/scenario/run_proof_file.hpp"
#include "common/security/node_keys.hpp"
#include "services/cloud-gateway/core/live/page_cursor.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/lists.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/api/scenario_body.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kMaxRunReason = 255;  ///< of PauseOrder and AbortOrder, which are signed
constexpr std::uint64_t kArchivePage = 100;
constexpr std::int64_t kExpiresH = 24;
constexpr std::int64_t kMaxExpiresH = 24 * 30;

void reply_view(const CallPtr& call, const Result<RunView>& view) {
  if (!view) return call->fail(view.error());
  call->reply(json_reply(to_json(*view)));
}

void show_run(Gateway& gateway, const CallPtr& call) {
  gateway.session.ask_node<RunView>(RunQuery{call->parameter("run")},
                                    [call](const Result<RunView>& view) { reply_view(call, view); });
}

void show_proof(Gateway& gateway, const CallPtr& call) {
  op::read_run_records(gateway.session, call->parameter("run"), [&gateway, call](const Result<RunRecords>& read) {
    if (!read) return call->fail(read.error());
    const auto keys = load_node_certificate(gateway.node_dir);
    if (!keys) return call->fail(keys.error());
    call->reply(json_reply(write_run_proof(read->run, read->records, keys->authority)));
  });
}

/// As the archive has it: a run that goes on is none of it yet.
void show_archived(Gateway& gateway, const CallPtr& call) {
  gateway.session.ask_node<RunView>(RunQuery{call->parameter("run")}, [call](const Result<RunView>& view) {
    if (!view || view->state >= RunState::finished) return reply_view(call, view);
    call->fail(fail(Errc::conflict, "run '" + view->run + "' is not over", "GET /api/v1/runs/" + view->run));
  });
}

std::string json_archive(const RunTable& table, const std::string& next) {
  std::string out = to_json(table);
  out.back() = ',';
  return out + "\"next\":" + json_quoted(next) + "}";
}

/// A page of the scheduler's archive, newest first; `?limit=` (100) and `?cursor=`, as of the other lists.
void list_archive(Gateway& gateway, const CallPtr& call) {
  const auto limit = call->query_number("limit", kArchivePage, kMaxPage);
  if (!limit) return call->fail(limit.error());
  if (*limit == 0) return call->fail(fail(Errc::bad_value, "limit: 0", "use 1 to " + std::to_string(kMaxPage)));
  const std::string list(call->decision.route->path);
  const std::string cursor = call->query("cursor");
  const auto after = cursor.empty() ? Result<PageCursor>(PageCursor{}) : parse_cursor(cursor, list);
  if (!after) return call->fail(after.error());
  const RunListRequest page{true, after->after, static_cast<std::uint32_t>(*limit)};
  gateway.session.ask_node<RunTable>(page, [call, list](const Result<RunTable>& table) {
    if (!table) return call->fail(table.error());
    const bool has_more = table->more && !table->runs.empty();
    const std::string next = has_more ? cursor_text({list, table->runs.back().run}) : std::string();
    call->reply(json_reply(json_archive(*table, next)));
  });
}

void pause(Gateway& gateway, const CallPtr& call, const std::string& reason) {
  op::pause_run(gateway.session, call->parameter("run"), reason,
                [call](const Result<RunView>& view) { reply_view(call, view); });
}

void resume(Gateway& gateway, const CallPtr& call, const std::string& reason) {
  op::resume_run(gateway.session, call->parameter("run"), reason,
                 [call](const Result<RunView>& view) { reply_view(call, view); });
}

void abort_it(Gateway& gateway, const CallPtr& call, const std::string& reason) {
  op::abort_run(gateway.session, {call->parameter("run"), reason},
                [call](const Result<RunView>& view) { reply_view(call, view); });
}

void submit(Gateway& gateway, const CallPtr& call, op::RunPlan plan, const op::RunTerms& terms) {
  op::submit_run(gateway.session, std::move(plan), terms, [call](const Result<std::string>& run) {
    if (!run) return call->fail(run.error());
    call->about += " " + *run;
    HttpReply out = json_reply(JsonObject().text("run", *run).done(), 201);
    out.headers.emplace_back("Location", "/api/v1/runs/" + *run);
    call->reply(std::move(out));
  });
}

Result<op::RunTerms> terms_of(const Members& body) {
  const auto hours = body.number_or("expires_h", kExpiresH, 1, kMaxExpiresH);
  if (!hours) return hours.error();
  const auto priority = body.number_or("priority", 0, 0, 9);
  if (!priority) return priority.error();
  return op::RunTerms{static_cast<double>(*hours), static_cast<std::uint32_t>(*priority)};
}

constexpr const char* kMember = "scenario";

/// Those that keep the run from beginning, with keys that lead into the request's body.
ConfigFaults in_body(const ConfigFaults& faults) {
  ConfigFaults out = faults_that_stop(faults);
  for (ConfigFault& one : out) one.key = kMember + (one.key.empty() ? "" : "." + one.key);
  return out;
}

void plan_and_submit(Gateway& gateway, const CallPtr& call, Scenario scenario, const op::RunTerms& terms) {
  op::plan_run(gateway.session, std::move(scenario), kScenarioFile, [&gateway, call, terms](Result<op::RunPlan> plan) {
    if (!plan) return call->fail(plan.error());
    const ConfigFaults faults = in_body(plan->faults);
    if (!faults.empty()) return call->reply(faults_reply(faults));
    submit(gateway, call, std::move(*plan), terms);
  });
}

/// {"scenario": SCENARIO, "priority": 0 to 9, "expires_h": HOURS}
void start_run(Gateway& gateway, const CallPtr& call) {
  const auto body = Members::of(*call, {"scenario", "priority", "expires_h"});
  if (!body) return call->fail(body.error());
  const Value* given = body->value(kMember);
  if (given == nullptr) return call->fail(fail(Errc::missing, "scenario: is missing", "add the scenario's object"));
  const auto terms = terms_of(*body);
  if (!terms) return call->fail(terms.error());
  ConfigFaults faults;
  Scenario scenario = scenario_of(*given, faults);
  if (!in_body(faults).empty()) return call->reply(faults_reply(in_body(faults)));
  call->about = "'" + scenario.name + "'";
  const std::string effect = "start of a run of scenario " + call->about;
  do_once(gateway, call, effect, [&gateway, call, scenario = std::move(scenario), terms = *terms] {
    plan_and_submit(gateway, call, scenario, terms);
  });
}

Handler order_of_run(Gateway& gateway, void (*act)(Gateway&, const CallPtr&, const std::string& reason)) {
  return [&gateway, act](const CallPtr& call) {
    const auto reason = reason_in(*call, kMaxRunReason);
    if (!reason) return call->fail(reason.error());
    call->about = *reason;
    const std::string said = with_name(*call, *reason, kMaxRunReason);
    order_once(
        gateway, call, "run", [&gateway, act, call, said] { act(gateway, call, said); },
        [&gateway, call] { show_run(gateway, call); });
  };
}

}  // namespace

void add_run_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/runs", [&](const CallPtr& call) { reply_rows(gateway, call, RowKind::run); });
  table.add(Method::get, "/api/v1/runs/{run}", [&](const CallPtr& call) { show_run(gateway, call); });
  table.add(Method::get, "/api/v1/runs/{run}/proof", [&](const CallPtr& call) { show_proof(gateway, call); });
  table.add(Method::get, "/api/v1/archive", [&](const CallPtr& call) { list_archive(gateway, call); });
  table.add(Method::get, "/api/v1/archive/{run}", [&](const CallPtr& call) { show_archived(gateway, call); });
  table.add(Method::post, "/api/v1/runs", of_gateway(gateway, start_run));
  table.add(Method::post, "/api/v1/runs/{run}/pause", order_of_run(gateway, pause));
  table.add(Method::post, "/api/v1/runs/{run}/resume", order_of_run(gateway, resume));
  table.add(Method::post, "/api/v1/runs/{run}/abort", order_of_run(gateway, abort_it));
}

}  // namespace trb::gateway
