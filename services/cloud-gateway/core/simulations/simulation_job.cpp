#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/simulation/job_beside.hpp"
#include "common/simulation/job_faults.hpp"
#include "common/simulation/job_link.hpp"
#include "common/simulation/job_sensors.hpp"
#include "common/simulation/job_times.hpp"

namespace trb::gateway {
namespace {

constexpr std::int64_t kMaxCountedRobots = 20'000;
constexpr std::int64_t kMaxCountedTasks = 1'000'000;
constexpr std::int64_t kMaxSensors = 1000;
constexpr std::int64_t kMaxRequests = 100'000;
constexpr Range kRate{0, 1000};
constexpr Range kUntil{0, kSeconds.to};
constexpr std::int64_t kMaxSeed = (1LL << 53) - 1;  ///< exact in a page

void check_counting(ObjectReader& reader) {
  const auto robots = reader.integer("robots", Need::required, 1, kMaxCountedRobots);
  reader.integer("tasks", Need::required, 1, kMaxCountedTasks);
  reader.integer("interpreted", Need::optional, 0, robots.value_or(kMaxCountedRobots));
  reader.number("task_seconds", Need::optional, kSeconds);
  reader.integer("sensors", Need::optional, 0, kMaxSensors);
  reader.number("rate", Need::optional, kRate);
  reader.number("seconds", Need::optional, kUntil);
  reader.integer("local_requests", Need::optional, 0, kMaxRequests);
  reader.integer("remote_requests", Need::optional, 0, kMaxRequests);
  reader.integer("faulty", Need::optional, 0, robots.value_or(kMaxCountedRobots) - 1);
}

/// The fleet's robots do it: how many they are, and how many tasks there are, is not said twice.
void check_scenario_keys(ObjectReader& reader) {
  reader.value("scenario", Need::required);
  for (const char* key : {"robots", "tasks"}) {
    if (reader.value(key, Need::optional) == nullptr) continue;
    reader.faults().add(key, "the fleet and the scenario say it", "leave it out, or leave scenario out");
  }
  simulation::read_times(reader);
  simulation::read_beside(reader);
}

/// What is wrong with their number is told already.
simulation::JobNodes counted_nodes(ObjectReader& reader) {
  const auto robots = reader.integer("robots", Need::required, 1, kMaxSimulatedRobots);
  reader.integer("tasks", Need::required, 1, kMaxSimulatedTasks);
  return simulation::JobNodes(static_cast<std::uint32_t>(robots.value_or(kMaxSimulatedRobots)));
}

/// As `trb simulate` reads its files.
void check_world(ObjectReader& reader, const simulation::JobNodes& nodes) {
  simulation::read_usual_time(reader);
  reader.number("seconds", Need::optional, kUntil);
  reader.integer("seed", Need::optional, 0, kMaxSeed);
  simulation::read_link(reader);
  simulation::read_faults(reader, nodes, kMaxSimulatedFaults);
  simulation::read_relays(reader, nodes);
  simulation::read_sensor_values(reader, nodes, kMaxSimulatedSensors);
}

/// A scenario is played by the real cores alone.
bool is_of_scenario(const Value& job) {
  return job.is_object() && job.find("scenario") != nullptr;
}

bool is_of_real_cores(const Value& job) {
  const Value* protocol = job.find("protocol");
  return protocol != nullptr && protocol->is_text() && protocol->text() == "talkrobots";
}

/// `job` without what a list of simulations has no room for.
Value::Object outline_of(const Value::Object& job) {
  constexpr std::array<std::string_view, 6> kLong{"scenario", "beside", "sensor_values", "times", "delays_s", "nodes"};
  Value::Object out;
  for (const auto& [key, value] : job) {
    if (std::ranges::find(kLong, key) != kLong.end()) continue;
    out.emplace_back(key, value);
    Value& last = out.back().second;
    if (key == "link" && value.is_object()) last = Value{outline_of(value.object())};
    if (key != "faults") continue;
    for (Value& fault : std::get<Value::List>(last.is)) fault = Value{outline_of(fault.object())};
  }
  return out;
}

}  // namespace

void check_simulation_job(const Value& job, const std::map<std::string, NodeProfile>& robots, ConfigFaults& faults) {
  ObjectReader reader(job, "", FileFaults("job", faults));
  const bool of_scenario = is_of_scenario(job);
  if (of_scenario) {
    reader.choice("protocol", Need::required, {"talkrobots"});
  } else {
    reader.choice("protocol", Need::optional, {"paper", "talkrobots"});
  }
  if (of_scenario) {
    check_scenario_keys(reader);
    check_world(reader, simulation::JobNodes(robots));
  } else if (is_of_real_cores(job)) {
    check_world(reader, counted_nodes(reader));
  } else {
    check_counting(reader);
  }
  reader.refuse_unknown_keys();
}

std::string simulation_outline(const Value& job) {
  return dump_json(Value{outline_of(job.object())});
}

SimulationJob counted_job(const Value& job) {
  const std::string text = dump_json(job);
  return {text, simulation_outline(job), text, job.find("robots")->integer(), job.find("tasks")->integer()};
}

std::string simulation_in_words(const SimulationJob& job) {
  std::string what = "paper";
  if (!job.scenarios.empty()) {
    what = "scenario " + in_quotes(job.scenarios.front().name);
    if (job.scenarios.size() > 1) what += " and " + std::to_string(job.scenarios.size() - 1) + " beside it";
  } else if (is_of_real_cores(*parse_json(job.text))) {
    what = "talkrobots";
  }
  return what + ", " + std::to_string(job.robots) + " robots, " + std::to_string(job.tasks) + " tasks";
}

}  // namespace trb::gateway
