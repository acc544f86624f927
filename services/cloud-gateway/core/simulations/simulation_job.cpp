#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::gateway {
namespace {

constexpr std::int64_t kMaxCountedRobots = 20'000;
constexpr std::int64_t kMaxCountedTasks = 1'000'000;
constexpr std::int64_t kMaxSensors = 1000;
constexpr std::int64_t kMaxRequests = 100'000;
constexpr Range kRate{0, 1000};
constexpr Range kUntil{0, kSeconds.to};
constexpr std::int64_t kMaxSeed = (1LL << 53) - 1;  ///< exact in a page
constexpr std::size_t kMaxNode = 64;
constexpr std::size_t kMaxTimes = 1000;

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

void check_fault(const Value& json, const std::string& path, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  reader.number("at", Need::required, kUntil);
  reader.choice("kind", Need::required, {"fail", "cut", "heal", "kill", "start"});
  reader.text("node", Need::required, kMaxNode);
  reader.text("other", Need::optional, kMaxNode);
  reader.refuse_unknown_keys();
}

void check_time(const std::string& skill, const Value& json, const FileFaults& faults) {
  const std::string path = "times." + skill;
  if (json.is_object()) {
    ObjectReader reader(json, path, faults);
    const auto mean = reader.number("mean", Need::required, kSeconds);
    reader.number("deviation", Need::optional, {0, mean.value_or(kSeconds.to)});
    reader.refuse_unknown_keys();
  } else if (!json.is_number() || !kSeconds.holds(json.number())) {
    faults.add(path, "no time", R"(write seconds, or {"mean": 3, "deviation": 0.5})");
  }
}

/// The fleet's robots do it: how many they are, and how many tasks there are, is not said twice.
void check_scenario_keys(ObjectReader& reader) {
  reader.value("scenario", Need::required);
  for (const char* key : {"robots", "tasks"}) {
    if (reader.value(key, Need::optional) == nullptr) continue;
    reader.faults().add(key, "the fleet and the scenario say it", "leave it out, or leave scenario out");
  }
  const Value::Object* times = reader.object("times", Need::optional, kMaxTimes);
  if (times == nullptr) return;
  for (const auto& [skill, time] : *times) check_time(skill, time, reader.faults());
}

void check_world(ObjectReader& reader, bool of_scenario) {
  if (of_scenario) {
    check_scenario_keys(reader);
  } else {
    reader.integer("robots", Need::required, 1, kMaxSimulatedRobots);
    reader.integer("tasks", Need::required, 1, kMaxSimulatedTasks);
  }
  reader.number("task_seconds", Need::optional, kSeconds);
  reader.number("deviation", Need::optional, kUntil);
  reader.number("seconds", Need::optional, kUntil);
  reader.integer("seed", Need::optional, 0, kMaxSeed);
  reader.choice("link", Need::optional, {"lan", "wifi", "vpn"});
  const Value::List* list = reader.list("faults", Need::optional, kMaxSimulatedFaults);
  if (list == nullptr) return;
  for (std::size_t i = 0; i < list->size(); ++i) {
    check_fault((*list)[i], "faults[" + std::to_string(i) + "]", reader.faults());
  }
}

/// A scenario is played by the real cores alone.
bool is_of_scenario(const Value& job) {
  return job.is_object() && job.find("scenario") != nullptr;
}

bool is_of_real_cores(const Value& job) {
  const Value* protocol = job.find("protocol");
  return protocol != nullptr && protocol->is_text() && protocol->text() == "talkrobots";
}

}  // namespace

void check_simulation_job(const Value& job, ConfigFaults& faults) {
  ObjectReader reader(job, "", FileFaults("job", faults));
  const bool of_scenario = is_of_scenario(job);
  if (of_scenario) {
    reader.choice("protocol", Need::required, {"talkrobots"});
  } else {
    reader.choice("protocol", Need::optional, {"paper", "talkrobots"});
  }
  of_scenario || is_of_real_cores(job) ? check_world(reader, of_scenario) : check_counting(reader);
  reader.refuse_unknown_keys();
}

SimulationJob counted_job(const Value& job) {
  const std::string text = dump_json(job);
  return {text, text, text, job.find("robots")->integer(), job.find("tasks")->integer()};
}

std::string simulation_in_words(const SimulationJob& job) {
  std::string what = "paper";
  if (job.scenario) {
    what = "scenario " + in_quotes(job.scenario->name);
  } else if (is_of_real_cores(*parse_json(job.text))) {
    what = "talkrobots";
  }
  return what + ", " + std::to_string(job.robots) + " robots, " + std::to_string(job.tasks) + " tasks";
}

}  // namespace trb::gateway
