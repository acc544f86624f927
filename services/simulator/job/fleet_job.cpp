#include "services/simulator/job/fleet_job.hpp"

#include <algorithm>

#include "common/base/ids.hpp"
#include "common/scenario/candidate_index.hpp"
#include "common/scenario/definition.hpp"
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

void bind(WorldPlan& plan, const FileFaults& faults, ConfigFaults& found) {
  const Profiles profiles = profiles_of(plan);
  check_scenario(plan.scenario, simulation::with_cloud(profiles, plan.sensors), kFile, found);
  simulation::check_conditions(plan.sensors, plan.scenario, faults);
  if (!faults_that_stop(found).empty()) return;
  simulation::check_times(plan.times, plan.scenario, faults);
  CandidateIndex candidates(profiles);
  plan.assigned = bind_tasks(plan.scenario, candidates, kCloud, kFile, found);
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
  if (scenario != nullptr && faults_that_stop(found).empty() && !plan.fleet.empty()) bind(plan, reader.faults(), found);
  plan.robots = static_cast<std::uint32_t>(plan.fleet.size());
  plan.tasks = static_cast<std::uint32_t>(plan.scenario.tasks.size());
  for (const ConfigFault& fault : faults_that_stop(found)) reader.faults().add(fault.key, fault.what, fault.hint);
}

}  // namespace trb::simulator
