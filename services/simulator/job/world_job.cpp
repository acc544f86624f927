#include "services/simulator/job/world_job.hpp"

#include <cstdio>

#include "services/simulator/job/fault_job.hpp"
#include "services/simulator/job/fleet_job.hpp"
#include "services/simulator/job/link_job.hpp"
#include "services/simulator/job/sensor_job.hpp"

namespace trb::simulator {
namespace {

std::string hex_of(std::uint64_t number) {
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(number));
  return out;
}

}  // namespace

world::WorldPlan read_world(ObjectReader& reader) {
  world::WorldPlan plan;
  if (reader.value("fleet", Need::optional) != nullptr) {
    read_fleet(reader, plan);
  } else {
    plan.robots =
        static_cast<std::uint32_t>(reader.integer("robots", Need::required, 1, world::kMaxRobots).value_or(1));
    plan.tasks = static_cast<std::uint32_t>(reader.integer("tasks", Need::required, 1, kMaxTasks).value_or(1));
    read_sensor_values(reader, plan);
  }
  plan.task.mean_s = reader.number("task_seconds", Need::optional, kSeconds).value_or(plan.task.mean_s);
  plan.task.deviation_s = reader.number("deviation", Need::optional, {0, plan.task.mean_s}).value_or(0);
  plan.until_s = reader.number("seconds", Need::optional, {0, world::kMaxUntil}).value_or(0);
  plan.seed = static_cast<std::uint64_t>(reader.integer("seed", Need::optional, 0, INT64_MAX).value_or(1));
  plan.link = read_link(reader);
  plan.until_event =
      static_cast<std::uint64_t>(reader.integer("until_event", Need::optional, 1, INT64_MAX).value_or(0));
  read_faults(reader, plan);
  return plan;
}

Value world_value(const world::Played& played) {
  const auto integer = [](std::uint64_t number) { return Value{static_cast<std::int64_t>(number)}; };
  Value::List broken;
  for (const std::string& text : played.broken) broken.push_back(Value{text});
  const bool over = played.over_everywhere;
  return Value{Value::Object{{"state", Value{over ? std::string(name_of(played.state)) : "OPEN"}},
                             {"over_everywhere", Value{over}},
                             {"tasks_done", integer(played.tasks_done)},
                             {"makespan_s", Value{played.makespan_s}},
                             {"linked_s", Value{played.linked_s}},
                             {"submitted_s", Value{played.submitted_s}},
                             {"events", integer(played.events)},
                             {"digest", Value{hex_of(played.digest)}},
                             {"broken", Value{std::move(broken)}}}};
}

}  // namespace trb::simulator
