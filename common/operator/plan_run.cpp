#include "common/operator/plan_run.hpp"

#include <memory>

#include "common/operator/routes.hpp"
#include "common/operator/scenario_check.hpp"
#include "common/scenario/definition.hpp"

namespace trb::op {
namespace {

void bind(RunPlan& plan, const std::string& file) {
  const Profiles profiles = profiles_of(plan.table);
  warn_of_skips(plan.scenario, file, plan.faults);
  check_scenario(plan.scenario, profiles, file, plan.faults);
  if (!faults_that_stop(plan.faults).empty()) return;
  warn_of_robots(plan.scenario, profiles, file, plan.faults);
  CandidateIndex candidates(profiles);
  plan.robots = bind_tasks(plan.scenario, candidates, plan.binder.node, file, plan.faults);
}

}  // namespace

void plan_run(Session& session, Scenario scenario, std::string file, Callback<RunPlan> done) {
  const auto plan = std::make_shared<RunPlan>();
  plan->scenario = std::move(scenario);
  const auto finish = [plan, file = std::move(file), done](Binder binder) {
    plan->binder = std::move(binder);
    bind(*plan, file);
    const bool stops = !faults_that_stop(plan->faults).empty();
    if (const Status whole = check_whole(plan->table); stops && !whole) return done(whole.error());
    done(std::move(*plan));
  };
  const auto choose = [&session, plan, finish](RouteTable table) {
    plan->table = std::move(table);
    find_binder(session, plan->scenario, plan->table, finish);
  };
  request_routes(session, on_success<RouteTable>(std::move(done), choose));
}

std::vector<BoundTask> bound_tasks(const RunPlan& plan) {
  std::vector<BoundTask> out;
  for (std::size_t i = 0; i < plan.scenario.tasks.size(); ++i) {
    const Task& task = plan.scenario.tasks[i];
    if (task.robot.empty()) out.push_back({task.id, plan.robots[i], plan.robots[i] == plan.binder.node});
  }
  return out;
}

}  // namespace trb::op
