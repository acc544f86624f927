#include "services/cloud-gateway/core/simulations/scenario_job.hpp"

#include <utility>

#include "common/fleet/did_you_mean.hpp"
#include "common/scenario/definition.hpp"
#include "common/scenario/played_tasks.hpp"
#include "common/simulation/job_beside.hpp"
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

/// By their places in the job; `key`: of the scenario.
void add_prefixed(const ConfigFaults& found, const std::string& key, ConfigFaults& faults) {
  for (const ConfigFault& one : faults_that_stop(found)) {
    add_fault(faults, one.key.empty() ? key : key + "." + one.key, one.what, one.hint);
  }
}

/// A scenario of the job, and its key there.
struct KeyedScenario {
  std::string key;
  Scenario scenario;
};

KeyedScenario read_checked(const Value& json, std::string key, ConfigFaults& faults) {
  ConfigFaults found;
  KeyedScenario out{std::move(key), read_scenario(json, kKey, found)};
  add_prefixed(found, out.key, faults);
  return out;
}

/// The job's own first. What is wrong with the list of those beside it was told before.
std::vector<KeyedScenario> read_scenarios(const Value& job, ConfigFaults& faults) {
  std::vector<KeyedScenario> out;
  out.push_back(read_checked(*job.find(kKey), kKey, faults));
  ConfigFaults told;
  ObjectReader reader(job, "", FileFaults("job", told));
  for (simulation::JobRun& run : simulation::read_beside(reader)) {
    out.push_back(read_checked(*run.scenario, std::move(run.path), faults));
  }
  return out;
}

bool is_without_robot(const KnownNodes& nodes, const std::string& id) {
  const auto at = nodes.find(id);
  return id != simulation::kCloud && at != nodes.end() && at->second.robot.empty();
}

/// The fleet's own cloud may have another name than the one that is played.
void check_names(const KeyedScenario& of, const KnownNodes& nodes, ConfigFaults& faults) {
  for (std::size_t i = 0; i < of.scenario.tasks.size(); ++i) {
    for (const Condition& condition : of.scenario.tasks[i].when) {
      if (!is_without_robot(nodes, condition.of)) continue;
      return add_fault(
          faults, of.key + ".tasks[" + std::to_string(i) + "].when.of",
          in_quotes(condition.of) + " has no robot: a simulation has the robots, and a cloud named 'cloud'",
          R"(write "of": "cloud" here, and give that node its sensor in sensor_values)");
    }
  }
}

/// As the simulator checks them: of the nodes it has the robots and a cloud, and a condition needs a sensor of the job.
void check_with_sensors(const Value& job, const std::vector<KeyedScenario>& scenarios, const KnownNodes& robots,
                        ConfigFaults& faults) {
  const FileFaults into("job", faults);
  ObjectReader reader(job, "", into);
  const auto sensors = simulation::read_sensor_values(reader, simulation::JobNodes(robots));
  const auto nodes = simulation::with_cloud(robots, sensors);
  std::vector<const Scenario*> all;
  for (const KeyedScenario& one : scenarios) {
    ConfigFaults found;
    check_scenario(one.scenario, nodes, kKey, found);
    add_prefixed(found, one.key, faults);
    simulation::check_conditions(sensors, one.scenario, into, one.key);
    all.push_back(&one.scenario);
  }
  if (faults.empty()) simulation::check_times(simulation::read_times(reader), all, into);
}

/// Together they are no more than the tasks of a counted job.
void check_together(const std::vector<KeyedScenario>& scenarios, ConfigFaults& faults) {
  std::size_t tasks = 0;
  for (const KeyedScenario& one : scenarios) tasks += one.scenario.tasks.size();
  if (scenarios.size() == 1 || tasks <= static_cast<std::size_t>(kMaxSimulatedTasks)) return;
  add_fault(faults, "beside", "the scenarios have " + std::to_string(tasks) + " tasks in all",
            "leave some out: " + std::to_string(kMaxSimulatedTasks) + " are played; trb simulate takes more");
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

/// What each of several runs takes by itself is part of their answer.
std::string input_of(const Value& job, Value::List fleet) {
  Value::Object out = std::get<Value::Object>(job.is);
  if (job.find("beside") != nullptr) out.emplace_back("alone", Value{true});
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
  std::vector<KeyedScenario> scenarios = read_scenarios(job, faults);
  for (const KeyedScenario& one : scenarios) {
    if (faults.empty()) check_names(one, nodes, faults);
  }
  if (faults.empty()) check_with_sensors(job, scenarios, robots_of(nodes), faults);
  if (faults.empty()) check_together(scenarios, faults);
  if (!faults.empty()) return out;
  out.robots = static_cast<std::int64_t>(fleet.size());
  for (KeyedScenario& one : scenarios) {
    out.tasks += static_cast<std::int64_t>(one.scenario.tasks.size());
    out.scenarios.push_back(std::move(one.scenario));
  }
  out.text = dump_json(job);
  out.outline = simulation_outline(job);
  out.input = input_of(job, std::move(fleet));
  if (out.input.size() > kMaxInput) {
    add_fault(faults, kKey, "with the robots' profiles it has " + std::to_string(out.input.size()) + " bytes",
              "leave descriptions out, or split it: " + std::to_string(kMaxInput) + " bytes are taken");
  }
  return out;
}

Bytes with_waits(Bytes answer, const std::vector<Scenario>& scenarios) {
  auto json = parse_json(answer, {.bytes = kMaxAnswer});
  if (!json || !json->is_object()) return answer;
  add_waits(*json, scenarios);
  return dump_json(*json);
}

}  // namespace trb::gateway
