// simulations: a fleet that is played in virtual time, by trb-simulator.
#include "services/cloud-gateway/core/simulations/scenario_job.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/api/scenario_body.hpp"
#include "services/cloud-gateway/io/json_text.hpp"
#include "services/cloud-gateway/io/simulation_runner.hpp"

namespace trb::gateway {
namespace {

std::string json_failure(const Error& error) {
  JsonObject out;
  out.text("code", errc_name(error.code)).text("detail", error.what);
  return out.text("hint", error.hint).done();
}

std::string names_of_others(const std::vector<Scenario>& scenarios) {
  Value::List out;
  for (std::size_t i = 1; i < scenarios.size(); ++i) out.push_back(Value{scenarios[i].name});
  return dump_json(Value{std::move(out)});
}

/// `job`: as it was asked for, or in a list without its scenario.
JsonObject json_simulation(const Simulation& one, const std::string& job) {
  JsonObject out;
  out.text("id", one.id).text("state", name_of(one.state)).text("by", one.by).time("asked", one.asked);
  if (one.began) out.time("began", *one.began);
  if (one.ended) out.time("ended", *one.ended);
  JsonObject progress;
  progress.raw("seconds", dump_json(Value{one.progress.seconds})).number("tasks_done", one.progress.tasks_done);
  out.raw("progress", progress.done()).raw("job", job);
  out.number("robots", static_cast<std::uint64_t>(one.job.robots));
  out.number("tasks", static_cast<std::uint64_t>(one.job.tasks));
  const std::vector<Scenario>& scenarios = one.job.scenarios;
  if (!scenarios.empty()) out.text("scenario", scenarios.front().name);
  if (scenarios.size() > 1) out.raw("beside", names_of_others(scenarios));
  if (one.failure) out.raw("failure", json_failure(*one.failure));
  return out;
}

/// All of them, without their answers and scenarios.
void list_simulations(const Gateway& gateway, const CallPtr& call) {
  JsonList items;
  for (const Simulation& one : gateway.simulations->desk().all())
    items.add(json_simulation(one, one.job.outline).done());
  call->reply(json_reply(JsonObject().raw("items", items.done()).done()));
}

void show_simulation(const Gateway& gateway, const CallPtr& call) {
  const Simulation* one = gateway.simulations->desk().find(call->parameter("simulation"));
  if (one == nullptr) {
    return call->reply(problem_reply(404, "missing", "there is no such simulation", "GET /api/v1/simulations"));
  }
  JsonObject out = json_simulation(*one, one->job.text);
  if (!one->answer.empty()) out.raw("answer", one->answer);
  call->reply(json_reply(out.done()));
}

/// By its id alone: a job may be longer than an answer that is kept for repeats.
void start(const Gateway& gateway, const CallPtr& call, SimulationJob job) {
  const auto added = gateway.simulations->add(std::move(job), call->who().name, gateway.now());
  if (!added) return call->fail(added.error());
  HttpReply out = json_reply(JsonObject().text("id", (*added)->id).done(), 202);
  out.headers.emplace_back("Location", "/api/v1/simulations/" + (*added)->id);
  call->reply(std::move(out));
}

KnownNodes known_nodes(const Gateway& gateway) {
  KnownNodes out;
  gateway.book.each(RowKind::profile, [&](const Row& row) {
    if (const auto* profile = std::get_if<NodeProfile>(&row.content)) out.emplace(row.key.node, *profile);
  });
  return out;
}

/// Errors: too_large.
Status check_size(const Call& call, std::size_t most) {
  const std::size_t size = call.request.body.size();
  if (size <= most) return Done{};
  return fail(Errc::too_large, "the job has " + std::to_string(size) + " bytes",
              "send at most " + std::to_string(most));
}

void start_simulation(Gateway& gateway, const CallPtr& call) {
  if (const Status size = check_size(*call, kMaxSimulationJob); !size) return call->fail(size.error());
  const auto body = body_of(*call);
  if (!body) return call->fail(body.error());
  const bool has_scenario = body->find("scenario") != nullptr;
  const KnownNodes nodes = has_scenario ? known_nodes(gateway) : KnownNodes{};
  ConfigFaults faults;
  check_simulation_job(*body, robots_of(nodes), faults);
  if (!faults.empty()) return call->reply(faults_reply(faults));
  SimulationJob job = has_scenario ? scenario_job(*body, nodes, faults) : counted_job(*body);
  if (!faults.empty()) return call->reply(faults_reply(faults));
  call->about = simulation_in_words(job);
  const std::string effect = "simulation: " + call->about;
  do_once(
      gateway, call, effect, [&gateway, call, job] { start(gateway, call, job); }, Acts::here);
}

/// One that is over is forgotten (204), any other one cancelled.
void remove_simulation(Gateway& gateway, const CallPtr& call) {
  const auto removed = gateway.simulations->remove(call->parameter("simulation"), gateway.now());
  if (!removed) {
    return call->reply(problem_reply(404, "missing", removed.error().what, removed.error().hint));
  }
  call->reply(*removed == nullptr ? empty_reply()
                                  : json_reply(json_simulation(**removed, (*removed)->job.text).done()));
}

}  // namespace

void add_simulation_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::get, "/api/v1/simulations", of_gateway(gateway, list_simulations));
  table.add(Method::post, "/api/v1/simulations", of_gateway(gateway, start_simulation));
  table.add(Method::get, "/api/v1/simulations/{simulation}", of_gateway(gateway, show_simulation));
  table.add(Method::delete_, "/api/v1/simulations/{simulation}", of_gateway(gateway, remove_simulation));
}

}  // namespace trb::gateway
