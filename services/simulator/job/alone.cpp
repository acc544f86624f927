#include "services/simulator/job/alone.hpp"

#include "common/simulation/job_times.hpp"

namespace trb::simulator {
namespace {

/// Run 0 is the first. Times of others' tasks alone do not let it be played for longer.
world::WorldPlan plan_alone(const world::WorldPlan& plan, std::size_t run) {
  world::WorldPlan out = plan;
  out.beside.clear();
  if (run > 0) {
    out.scenario = plan.beside[run - 1].scenario;
    out.assigned = plan.beside[run - 1].assigned;
  }
  std::erase_if(out.times, [&](const auto& time) { return !simulation::is_time_of(time.first, out.scenario); });
  return out;
}

Value alone_s(const world::WorldPlan& plan, std::size_t run,
              const std::function<void(const world::World&)>& on_second) {
  world::World world(plan_alone(plan, run));
  world.on_second = on_second;
  const world::Played played = world.play();
  return played.state == RunState::finished ? Value{played.makespan_s} : Value{};
}

}  // namespace

void add_alone(Value& answer, const world::WorldPlan& plan, const std::function<void(const world::World&)>& on_second) {
  auto& members = std::get<Value::Object>(answer.is);
  for (auto& [key, value] : members) {
    if (key != "beside") continue;
    auto& runs = std::get<Value::List>(value.is);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      std::get<Value::Object>(runs[i].is).emplace_back("alone_s", alone_s(plan, i + 1, on_second));
    }
  }
  members.emplace_back("alone_s", alone_s(plan, 0, on_second));
}

}  // namespace trb::simulator
