#include "services/simulator/job/fleet_job.hpp"

#include <algorithm>

#include "common/base/ids.hpp"
#include "common/scenario/candidate_index.hpp"
#include "common/scenario/definition.hpp"
#include "common/simulation/job_beside.hpp"
#include "common/simulation/job_sensors.hpp"
#include "common/simulation/job_times.hpp"
#include "proto/body.hpp"

namespace trb::simulator {
namespace {

using simulation::kCloud;
using simulation::kMaxId;
using world::PlannedRobot;
using world::WorldPlan;

constexpr const char* kFile = "scenario";

void read_robot(ObjectReader& reader, WorldPlan& plan) {
  PlannedRobot robot;
  robot.id = reader.text("id", Need::required, kMaxId).value_or("");
  const Value* profile = reader.value("profile", Need::required);
  reader.refuse_unknown_keys();
  if (profile == nullptr || robot.id.empty()) return;
  if (const auto id = check_id(reader.path("id"), robot.id); !id) {
    return reader.faults().add(reader.path("id"), id.error().what, id.error().hint);
  }
  const bool is_taken = robot.id == kCloud || std::ranges::any_of(plan.fleet, [&](const PlannedRobot& other) {
                          return other.id == robot.id;
                        });
  if (is_taken) return reader.faults().add(reader.path("id"), "'" + robot.id + "' is taken", "give each robot its own");
  auto read = from_json<NodeProfile>(dump_json(*profile));
  if (!read) return reader.faults().add(reader.path("profile"), read.error().what, read.error().hint);
  robot.profile = std::move(*read);
  robot.profile.robot = "ONLINE";
  plan.fleet.push_back(std::move(robot));
}

using Profiles = std::map<std::string, NodeProfile>;

Profiles profiles_of(const WorldPlan& plan) {
  Profiles out;
  for (const PlannedRobot& robot : plan.fleet) out.emplace(robot.id, robot.profile);
  return out;
}

/// The profiles of the fleet get the sensors.
void read_sensors(ObjectReader& reader, WorldPlan& plan) {
  Profiles profiles = profiles_of(plan);
  plan.sensors = simulation::read_sensor_values(reader, simulation::JobNodes(profiles));
  simulation::plug_in(plan.sensors, profiles);
  for (PlannedRobot& robot : plan.fleet) robot.profile = profiles.at(robot.id);
}

/// What all scenarios of a job are checked with.
struct Hall {
  explicit Hall(const WorldPlan& plan) : profiles(profiles_of(plan)), candidates(profiles), sensors(plan.sensors) {}
  Profiles profiles;
  CandidateIndex candidates;
  const std::vector<world::PlannedSensor>& sensors;
};

/// As `trb scenario run` does it: each by itself, whatever else goes on.
std::vector<std::string> bound(const Scenario& scenario, Hall& hall, const std::string& key, const FileFaults& faults,
                               ConfigFaults& found) {
  check_scenario(scenario, simulation::with_cloud(hall.profiles, hall.sensors), kFile, found);
  simulation::check_conditions(hall.sensors, scenario, faults, key);
  if (!faults_that_stop(found).empty()) return {};
  return bind_tasks(scenario, hall.candidates, kCloud, kFile, found);
}

/// Its faults, by their places in the job.
void add_faults(const ConfigFaults& found, const std::string& path, const FileFaults& faults) {
  for (const ConfigFault& fault : faults_that_stop(found)) {
    const std::string dot = fault.key.empty() ? "" : ".";
    faults.add(path.empty() ? fault.key : path + dot + fault.key, fault.what, fault.hint);
  }
}

void read_run(const simulation::JobRun& read, Hall& hall, const FileFaults& faults, WorldPlan& plan) {
  world::PlannedRun run;
  run.after_s = read.after_s;
  ConfigFaults found;
  run.scenario = read_scenario(*read.scenario, kFile, found);
  if (faults_that_stop(found).empty()) run.assigned = bound(run.scenario, hall, read.path, faults, found);
  add_faults(found, read.path, faults);
  plan.beside.push_back(std::move(run));
}

std::vector<const Scenario*> scenarios_of(const WorldPlan& plan) {
  std::vector<const Scenario*> out{&plan.scenario};
  for (const world::PlannedRun& run : plan.beside) out.push_back(&run.scenario);
  return out;
}

}  // namespace

void read_fleet(ObjectReader& reader, WorldPlan& plan) {
  const Value::List* robots = reader.list("fleet", Need::required, world::kMaxRobots);
  for (std::size_t i = 0; robots != nullptr && i < robots->size(); ++i) {
    ObjectReader one((*robots)[i], "fleet[" + std::to_string(i) + "]", reader.faults());
    read_robot(one, plan);
  }
  read_sensors(reader, plan);
  const Value* scenario = reader.value("scenario", Need::required);
  ConfigFaults found;
  if (scenario != nullptr) plan.scenario = read_scenario(*scenario, kFile, found);
  plan.times = simulation::read_times(reader);
  if (plan.fleet.empty() && robots != nullptr) reader.faults().add("fleet", "no robot", "add one");
  Hall hall(plan);
  const bool is_read = scenario != nullptr && faults_that_stop(found).empty() && !plan.fleet.empty();
  if (is_read) plan.assigned = bound(plan.scenario, hall, kFile, reader.faults(), found);
  for (const simulation::JobRun& run : simulation::read_beside(reader)) read_run(run, hall, reader.faults(), plan);
  if (is_read && faults_that_stop(found).empty())
    simulation::check_times(plan.times, scenarios_of(plan), reader.faults());
  plan.robots = static_cast<std::uint32_t>(plan.fleet.size());
  plan.tasks = static_cast<std::uint32_t>(plan.scenario.tasks.size());
  add_faults(found, "", reader.faults());
}

}  // namespace trb::simulator
