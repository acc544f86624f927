#include "services/cloud-gateway/core/simulations/scenario_job.hpp"

#include <utility>

#include "common/fleet/did_you_mean.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/played_tasks.hpp"
#include "common/simulation/job_sensors.hpp"
#include "common/simulation/job_times.hpp"
#include "proto/body.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kKey = "scenario";
constexpr std::size_t kMaxInput = 1U << 20U;  ///< of trb-simulator's job
constexpr std::size_t kMaxAnswer = 4U << 20U;

void add_fault(ConfigFaults& faults, const std::string& key, std::string what, std::string hint) {
  faults.push_back({"job", key, std::move(what), std::move(hint), false});
}

/// By their places in the job.
void add_prefixed(const ConfigFaults& found, ConfigFaults& faults) {
  for (const ConfigFault& one : faults_that_stop(found)) {
    add_fault(faults, one.key.empty() ? kKey : std::string(kKey) + "." + one.key, one.what, one.hint);
  }
}

Scenario read_checked(const Value& json, ConfigFaults& faults) {
  ConfigFaults found;
  Scenario out = read_scenario(json, kKey, found);
  add_prefixed(found, faults);
  return out;
}

bool is_without_robot(const KnownNodes& nodes, const std::string& id) {
  const auto at = nodes.find(id);
  return id != simulation::kCloud && at != nodes.end() && at->second.robot.empty();
}

/// The fleet's own cloud may have another name than the one that is played.
void check_names(const Scenario& scenario, const KnownNodes& nodes, ConfigFaults& faults) {
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    for (const Condition& condition : scenario.tasks[i].when) {
      if (!is_without_robot(nodes, condition.of)) continue;
      return add_fault(
          faults, std::string(kKey) + ".tasks[" + std::to_string(i) + "].when.of",
          in_quotes(condition.of) + " has no robot: a simulation has the robots, and a cloud named 'cloud'",
          R"(write "of": "cloud" here, and give that node its sensor in sensor_values)");
    }
  }
}

/// As the simulator checks it: of the nodes it has the robots and a cloud, and a condition needs a sensor of the job.
void check_with_sensors(const Value& job, const Scenario& scenario, const KnownNodes& robots, ConfigFaults& faults) {
  const FileFaults into("job", faults);
  ObjectReader reader(job, "", into);
  const auto sensors = simulation::read_sensor_values(reader, simulation::JobNodes(robots));
  ConfigFaults found;
  check_scenario(scenario, simulation::with_cloud(robots, sensors), kKey, found);
  add_prefixed(found, faults);
  simulation::check_conditions(sensors, scenario, into);
  if (faults.empty()) simulation::check_times(simulation::read_times(reader), scenario, into);
}

Value::List fleet_of(const KnownNodes& nodes) {
  Value::List out;
  for (const auto& [id, profile] : robots_of(nodes)) {
    out.push_back(Value{Value::Object{{"id", Value{id}}, {"profile", *parse_json(to_json(profile))}}});
  }
  return out;
}

void check_fleet(const Value::List& fleet, ConfigFaults& faults) {
  if (fleet.empty()) add_fault(faults, kKey, "no robot of the fleet is known yet", "wait until one is shown");
  if (fleet.size() > static_cast<std::size_t>(kMaxSimulatedRobots)) {
    add_fault(faults, kKey, "the fleet has " + std::to_string(fleet.size()) + " robots",
              "trb simulate takes more than " + std::to_string(kMaxSimulatedRobots));
  }
}

std::string input_of(const Value& job, Value::List fleet) {
  Value::Object out = std::get<Value::Object>(job.is);
  out.emplace_back("fleet", Value{std::move(fleet)});
  return dump_json(Value{std::move(out)});
}

}  // namespace

KnownNodes robots_of(const KnownNodes& nodes) {
  KnownNodes out;
  for (const auto& [id, profile] : nodes) {
    if (!profile.robot.empty()) out.emplace(id, profile);
  }
  return out;
}

SimulationJob scenario_job(const Value& job, const KnownNodes& nodes, ConfigFaults& faults) {
  SimulationJob out;
  Value::List fleet = fleet_of(nodes);
  check_fleet(fleet, faults);
  if (!faults.empty()) return out;
  out.scenario = read_checked(*job.find(kKey), faults);
  if (faults.empty()) check_names(*out.scenario, nodes, faults);
  if (faults.empty()) check_with_sensors(job, *out.scenario, robots_of(nodes), faults);
  if (!faults.empty()) return out;
  out.robots = static_cast<std::int64_t>(fleet.size());
  out.tasks = static_cast<std::int64_t>(out.scenario->tasks.size());
  out.text = dump_json(job);
  out.outline = simulation_outline(job);
  out.input = input_of(job, std::move(fleet));
  if (out.input.size() > kMaxInput) {
    add_fault(faults, kKey, "with the robots' profiles it has " + std::to_string(out.input.size()) + " bytes",
              "leave descriptions out, or split it: " + std::to_string(kMaxInput) + " bytes are taken");
  }
  return out;
}

Bytes with_waits(Bytes answer, const Scenario& scenario) {
  auto json = parse_json(answer, {.bytes = kMaxAnswer});
  if (!json || !json->is_object()) return answer;
  Value waits = waits_value(played_tasks(*json, scenario));
  std::get<Value::Object>(json->is).emplace_back("waits", std::move(waits));
  return dump_json(*json);
}

}  // namespace trb::gateway
