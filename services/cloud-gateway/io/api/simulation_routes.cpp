// simulations: a fleet that is played in virtual time, by trb-simulator.
#include "services/cloud-gateway/core/simulations/simulation_job.hpp"
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

JsonObject json_simulation(const Simulation& one) {
  JsonObject out;
  out.text("id", one.id).text("state", name_of(one.state)).text("by", one.by).time("asked", one.asked);
  if (one.began) out.time("began", *one.began);
  if (one.ended) out.time("ended", *one.ended);
  JsonObject progress;
  progress.raw("seconds", dump_json(Value{one.progress.seconds})).number("tasks_done", one.progress.tasks_done);
  out.raw("progress", progress.done()).raw("job", one.job);
  if (one.failure) out.raw("failure", json_failure(*one.failure));
  return out;
}

/// All of them, without their answers.
void list_simulations(const Gateway& gateway, const CallPtr& call) {
  JsonList items;
  for (const Simulation& one : gateway.simulations->desk().all()) items.add(json_simulation(one).done());
  call->reply(json_reply(JsonObject().raw("items", items.done()).done()));
}

void show_simulation(const Gateway& gateway, const CallPtr& call) {
  const Simulation* one = gateway.simulations->desk().find(call->parameter("simulation"));
  if (one == nullptr) {
    return call->reply(problem_reply(404, "missing", "there is no such simulation", "GET /api/v1/simulations"));
  }
  JsonObject out = json_simulation(*one);
  if (!one->answer.empty()) out.raw("answer", one->answer);
  call->reply(json_reply(out.done()));
}

void start(const Gateway& gateway, const CallPtr& call, const Value& job) {
  const auto added = gateway.simulations->add(dump_json(job), call->who().name, gateway.now());
  if (!added) return call->fail(added.error());
  HttpReply out = json_reply(json_simulation(**added).done(), 202);
  out.headers.emplace_back("Location", "/api/v1/simulations/" + (*added)->id);
  call->reply(std::move(out));
}

void start_simulation(Gateway& gateway, const CallPtr& call) {
  if (call->request.body.size() > kMaxSimulationJob) {
    return call->reply(problem_reply(413, "too_large",
                                     "the job has " + std::to_string(call->request.body.size()) + " bytes",
                                     "send at most " + std::to_string(kMaxSimulationJob)));
  }
  const auto job = body_of(*call);
  if (!job) return call->fail(job.error());
  ConfigFaults faults;
  check_simulation_job(*job, faults);
  if (!faults.empty()) return call->reply(faults_reply(faults));
  call->about = simulation_in_words(*job);
  do_once(gateway, call, "simulation: " + call->about, [&gateway, call, job = *job] { start(gateway, call, job); });
}

/// One that is over is forgotten (204), any other one cancelled.
void remove_simulation(Gateway& gateway, const CallPtr& call) {
  const auto removed = gateway.simulations->remove(call->parameter("simulation"), gateway.now());
  if (!removed) {
    return call->reply(problem_reply(404, "missing", removed.error().what, removed.error().hint));
  }
  call->reply(*removed == nullptr ? empty_reply() : json_reply(json_simulation(**removed).done()));
}

}  // namespace

void add_simulation_routes(Gateway& gateway, HandlerTable& table) {
  const auto add = [&](Method method, std::string_view path, auto act) {
    table.add(method, path, [&gateway, act](const CallPtr& call) { act(gateway, call); });
  };
  add(Method::get, "/api/v1/simulations", list_simulations);
  add(Method::post, "/api/v1/simulations", start_simulation);
  add(Method::get, "/api/v1/simulations/{simulation}", show_simulation);
  add(Method::delete_, "/api/v1/simulations/{simulation}", remove_simulation);
}

}  // namespace trb::gateway
