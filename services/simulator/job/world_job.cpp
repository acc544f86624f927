#include "services/simulator/job/world_job.hpp"

#include <algorithm>
#include <cstdio>

#include "common/simulation/job_faults.hpp"
#include "common/simulation/job_link.hpp"
#include "common/simulation/job_sensors.hpp"
#include "common/simulation/job_times.hpp"
#include "services/simulator/job/fleet_job.hpp"

namespace trb::simulator {
namespace {

std::string hex_of(std::uint64_t number) {
  char out[17];
  std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(number));
  return out;
}

simulation::JobNodes nodes_of(const world::WorldPlan& plan) {
  std::map<std::string, NodeProfile> fleet;
  for (const world::PlannedRobot& robot : plan.fleet) fleet.emplace(robot.id, robot.profile);
  return fleet.empty() ? simulation::JobNodes(plan.robots) : simulation::JobNodes(std::move(fleet));
}

/// What check_run_start would refuse once the fleet is up.
void check_size(const ObjectReader& reader, const world::WorldPlan& plan) {
  const world::RunSize most = world::largest_run(plan.tasks, plan.robots, plan.division);
  if (most.tasks > world::kMostTasksOfRun) {
    reader.faults().add(
        "tasks",
        "a run would have " + std::to_string(most.tasks) + ", and may have " + std::to_string(world::kMostTasksOfRun),
        "use more runs");
  }
  if (most.robots > world::kMostRobotsOfRun) {
    reader.faults().add("robots",
                        std::to_string(most.robots) + " of them would be in one run, which may have " +
                            std::to_string(world::kMostRobotsOfRun),
                        "use more runs, or fewer robots");
  }
}

void read_counted(ObjectReader& reader, world::WorldPlan& plan) {
  plan.robots = static_cast<std::uint32_t>(reader.integer("robots", Need::required, 1, world::kMaxRobots).value_or(1));
  plan.division.runs =
      static_cast<std::uint32_t>(reader.integer("runs", Need::optional, 1, world::kMostRuns).value_or(1));
  plan.division.at_once = reader.boolean("at_once", Need::optional).value_or(false);
  const std::int64_t most = std::int64_t{kMaxTasks} * plan.division.runs;
  plan.tasks = static_cast<std::uint32_t>(reader.integer("tasks", Need::required, 1, most).value_or(1));
  check_size(reader, plan);
  plan.sensors = simulation::read_sensor_values(reader, nodes_of(plan));
}

Value::List texts_of(const std::vector<std::string>& texts, std::size_t most) {
  Value::List out;
  for (std::size_t i = 0; i < std::min(texts.size(), most); ++i) out.push_back(Value{texts[i]});
  return out;
}

Value alert_value(const Alert& alert) {
  return Value{Value::Object{{"robot", Value{alert.robot}},
                             {"cause", Value{alert.cause}},
                             {"text", Value{alert.text}},
                             {"tasks", Value{texts_of(alert.tasks, kMaxListedAlerts)}}}};
}

void add_standstill(const world::Standstill& is, Value::Object& out) {
  Value::List alerts;
  for (std::size_t i = 0; i < std::min(is.alerts.size(), kMaxListedAlerts); ++i) {
    alerts.push_back(alert_value(is.alerts[i]));
  }
  out.emplace_back("alerts", Value{std::move(alerts)});
  if (is.still_s > 0) out.emplace_back("stands_still_s", Value{is.still_s});
  out.emplace_back("at_work", Value{static_cast<std::int64_t>(is.at_work)});
  out.emplace_back("finished_at_cloud", Value{is.is_finished});
  out.emplace_back("open_at", Value{texts_of(is.open_at, world::kMaxRobots + 1)});
  out.emplace_back("off", Value{texts_of(is.off, world::kMaxRobots + 1)});
}

Value whole(std::uint64_t number) {
  return Value{static_cast<std::int64_t>(number)};
}

Value state_of(const world::PlayedRun& played) {
  return Value{played.state ? std::string(name_of(*played.state)) : "OPEN"};
}

void add_end(const world::PlayedRun& played, Value::Object& out) {
  if (played.cut_off) out.emplace_back("cut_off", Value{true});
  if (played.standstill) add_standstill(*played.standstill, out);
}

/// Left out, if there is none: a plan has sensors for a scenario's conditions alone.
void add_steps_not_reached(const std::vector<world::LateSensor>& sensors, Value::Object& out) {
  if (sensors.empty()) return;
  Value::List list;
  for (const world::LateSensor& one : sensors) {
    list.push_back(Value{
        Value::Object{{"sensor", whole(one.index)}, {"at", Value{one.late.at_s}}, {"steps", whole(one.late.steps)}}});
  }
  out.emplace_back("steps_not_reached", Value{std::move(list)});
}

}  // namespace

world::WorldPlan read_world(ObjectReader& reader) {
  world::WorldPlan plan;
  if (reader.value("fleet", Need::optional) != nullptr) {
    read_fleet(reader, plan);
  } else {
    read_counted(reader, plan);
  }
  plan.task = simulation::read_usual_time(reader);
  plan.until_s = reader.number("seconds", Need::optional, {0, world::kMaxUntil}).value_or(0);
  plan.seed = static_cast<std::uint64_t>(reader.integer("seed", Need::optional, 0, INT64_MAX).value_or(1));
  plan.link = simulation::read_link(reader);
  plan.until_event =
      static_cast<std::uint64_t>(reader.integer("until_event", Need::optional, 1, INT64_MAX).value_or(0));
  const simulation::JobNodes nodes = nodes_of(plan);
  plan.faults = simulation::read_faults(reader, nodes);
  plan.relays = simulation::read_relays(reader, nodes);
  plan.must_end = plan.faults.empty() && plan.sensors.empty() && !plan.link.name.empty();
  return plan;
}

Value world_value(const world::Played& played) {
  Value::List not_reached;
  for (const world::LateFault& late : played.not_reached) {
    not_reached.push_back(Value{Value::Object{{"fault", whole(late.index)}, {"at", Value{late.at_s}}}});
  }
  Value::Object out{{"state", state_of(played)},
                    {"over_everywhere", Value{played.over_everywhere}},
                    {"tasks_done", whole(played.tasks_done)},
                    {"makespan_s", Value{played.makespan_s}},
                    {"all_linked", Value{played.all_linked}},
                    {"linked_s", Value{played.linked_s}},
                    {"submitted_s", Value{played.submitted_s}},
                    {"events", whole(played.events)},
                    {"digest", Value{hex_of(played.digest)}},
                    {"broken", Value{texts_of(played.broken, played.broken.size())}},
                    {"not_reached", Value{std::move(not_reached)}}};
  add_steps_not_reached(played.steps_not_reached, out);
  add_end(played, out);
  return Value{std::move(out)};
}

Value::Object beside_value(const world::WorldRun& run) {
  const world::PlayedRun& played = run.outcome;
  Value::Object out{{"scenario", Value{run.plan.scenario.name}},
                    {"after_s", Value{run.plan.after_s}},
                    {"state", state_of(played)},
                    {"over_everywhere", Value{played.over_everywhere}},
                    {"tasks_done", whole(played.tasks_done)},
                    {"makespan_s", Value{played.makespan_s}},
                    {"submitted_s", Value{played.submitted_s}},
                    {"broken", Value{texts_of(played.broken, played.broken.size())}}};
  add_end(played, out);
  return out;
}

}  // namespace trb::simulator
