#include "services/simulator/job/model_answer.hpp"

#include <set>

namespace trb::simulator {
namespace {

using model::PaperParameters;

PaperParameters of_world(const world::WorldPlan& plan) {
  PaperParameters p{.n = plan.robots, .N_i = plan.tasks};
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
  return p;
}

}  // namespace

PaperParameters parameters_of(const Job& job) {
  PaperParameters p = job.world ? of_world(*job.world) : of_plan(job.plan);
  // Tasks in turn: with one robot they are one block, else there is none.
  const std::uint64_t tasks = model::tasks(p);
  p.k = p.n == 1 && tasks > 1 ? 1 : 0;
  p.sum_m = p.k * tasks;
  return p;
}

Value model_value(const PaperParameters& p) {
  Value::Object phases{{"boot", Value{model::boot(p)}},       {"identification", Value{model::identification(p)}},
                       {"devices", Value{model::devices(p)}}, {"task", Value{model::task(p)}},
                       {"forward", Value{model::forward(p)}}, {"sensor", Value{model::sensor(p)}},
                       {"fail", Value{model::failures(p)}}};
  return Value{Value::Object{{"phases", Value{std::move(phases)}}, {"messages", Value{model::total(p)}}}};
}

}  // namespace trb::simulator
