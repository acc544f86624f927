#include "services/simulator/job/fleet_job.hpp"

#include <algorithm>

#include "common/base/ids.hpp"
#include "common/scenario/candidate_index.hpp"
#include "common/scenario/definition.hpp"
#include "proto/body.hpp"
#include "services/simulator/job/plan_nodes.hpp"
#include "services/simulator/job/sensor_job.hpp"

namespace trb::simulator {
namespace {

using world::PlannedRobot;
using world::WorldPlan;

constexpr std::size_t kMaxTimes = 1000;
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

void read_time(const std::string& skill, const Value& json, WorldPlan& plan, const FileFaults& faults) {
  world::SkillTime time;
  const std::string path = "times." + skill;
  if (json.is_object()) {
    ObjectReader reader(json, path, faults);
    time.mean_s = reader.number("mean", Need::required, kSeconds).value_or(time.mean_s);
    time.deviation_s = reader.number("deviation", Need::optional, {0, time.mean_s}).value_or(0);
    reader.refuse_unknown_keys();
  } else if (json.is_number() && kSeconds.holds(json.number())) {
    time.mean_s = json.number();
  } else {
    return faults.add(path, "no time", R"(write seconds, or {"mean": 3, "deviation": 0.5})");
  }
  plan.times[skill] = time;
}

void bind(WorldPlan& plan, const FileFaults& faults, ConfigFaults& found) {
  std::map<std::string, NodeProfile> profiles;
  for (const PlannedRobot& robot : plan.fleet) profiles[robot.id] = robot.profile;
  check_scenario(plan.scenario, profiles, kFile, found);
  check_conditions(plan, faults);
  if (!faults_that_stop(found).empty()) return;
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
  read_sensor_values(reader, plan);
  const Value* scenario = reader.value("scenario", Need::required);
  ConfigFaults found;
  if (scenario != nullptr) plan.scenario = read_scenario(*scenario, kFile, found);
  if (const Value::Object* times = reader.object("times", Need::optional, kMaxTimes)) {
    for (const auto& [skill, time] : *times) read_time(skill, time, plan, reader.faults());
  }
  if (plan.fleet.empty() && robots != nullptr) reader.faults().add("fleet", "no robot", "add one");
  if (scenario != nullptr && faults_that_stop(found).empty() && !plan.fleet.empty()) bind(plan, reader.faults(), found);
  plan.robots = static_cast<std::uint32_t>(plan.fleet.size());
  plan.tasks = static_cast<std::uint32_t>(plan.scenario.tasks.size());
  for (const ConfigFault& fault : faults_that_stop(found)) reader.faults().add(fault.key, fault.what, fault.hint);
}

}  // namespace trb::simulator
