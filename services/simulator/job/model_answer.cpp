#include "services/simulator/job/model_answer.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "common/model/scenario_parameters.hpp"

namespace trb::simulator {
namespace {

using model::PaperParameters;

/// Each task is told field by field, whoever has it; one that names no robot counts as that of who was given it.
PaperParameters of_scenario(const world::WorldPlan& plan) {
  Scenario scenario = plan.scenario;
  for (std::size_t i = 0; i < std::min(plan.assigned.size(), scenario.tasks.size()); ++i) {
    if (plan.assigned[i] != simulation::kCloud) scenario.tasks[i].robot = plan.assigned[i];
  }
  PaperParameters p = model::parameters_of(scenario, {}).paper;
  p.n = plan.robots;
  p.N_i = std::exchange(p.N_d, 0);
  return p;
}

/// With one robot they are one block, else there is none.
PaperParameters in_turn(PaperParameters p) {
  const std::uint64_t tasks = model::tasks(p);
  p.k = p.n == 1 && tasks > 1 ? 1 : 0;
  p.sum_m = p.k * tasks;
  return p;
}

PaperParameters of_world(const world::WorldPlan& plan) {
  PaperParameters p = plan.fleet.empty() ? in_turn({.n = plan.robots, .N_i = plan.tasks}) : of_scenario(plan);
  std::set<std::string> failed;
  for (const world::Fault& fault : plan.faults) {
    if (fault.kind == world::FaultKind::fail) failed.insert(fault.node);
  }
  p.N_f = failed.size();
  return p;
}

PaperParameters of_plan(const counting::Plan& plan) {
  PaperParameters p{.n = plan.robots, .s = plan.device_rates.size()};
  for (const counting::PlannedTask& task : plan.tasks) {
    ++(task.interpreted ? p.N_i : p.N_d);
    p.R_l += task.local_requests;
    p.R_e += task.remote_requests;
    p.N_f += task.taken_over ? 1 : 0;
  }
  for (const double rate : plan.device_rates) p.sum_x += rate;
  p.delta_t = plan.seconds > 0 ? plan.seconds : plan.task_s * static_cast<double>(plan.tasks.size());
  return in_turn(p);
}

}  // namespace

PaperParameters parameters_of(const Job& job) {
  return job.world ? of_world(*job.world) : of_plan(job.plan);
}

Value model_value(const PaperParameters& p) {
  Value::Object phases{{"boot", Value{model::boot(p)}},       {"identification", Value{model::identification(p)}},
                       {"devices", Value{model::devices(p)}}, {"task", Value{model::task(p)}},
                       {"forward", Value{model::forward(p)}}, {"sensor", Value{model::sensor(p)}},
                       {"fail", Value{model::failures(p)}}};
  return Value{Value::Object{{"phases", Value{std::move(phases)}}, {"messages", Value{model::total(p)}}}};
}

}  // namespace trb::simulator
