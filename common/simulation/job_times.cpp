#include "common/simulation/job_times.hpp"

#include <set>
#include <vector>

#include "common/fleet/did_you_mean.hpp"

namespace trb::simulation {
namespace {

constexpr std::string_view kOfTask = "task:";
constexpr std::size_t kMaxResult = 1024;  ///< bytes
constexpr std::size_t kMostUnknown = 10;  ///< a suggestion for each of a thousand would take a second

SkillTime read_time(const std::string& path, const Value& json, const FileFaults& faults) {
  SkillTime out;
  if (json.is_object()) {
    ObjectReader reader(json, path, faults);
    out.mean_s = reader.number("mean", Need::required, kSeconds).value_or(out.mean_s);
    out.deviation_s = reader.number("deviation", Need::optional, {0, out.mean_s}).value_or(0);
    if (const Value* result = reader.value("result", Need::optional)) out.result = dump_json(*result);
    if (out.result.size() > kMaxResult) {
      faults.add(path + ".result", "has " + std::to_string(out.result.size()) + " bytes",
                 "use " + std::to_string(kMaxResult) + " at most");
    }
    reader.refuse_unknown_keys();
  } else if (json.is_number() && kSeconds.holds(json.number())) {
    out.mean_s = json.number();
  } else {
    faults.add(path, "no time", R"(write seconds, or {"mean": 3, "deviation": 0.5})");
  }
  return out;
}

/// The one that counts for the task; nullptr: none of its own.
const SkillTime* time_of(const std::map<std::string, SkillTime>& times, const Task& task) {
  auto found = times.find(std::string(kOfTask) + task.id);
  if (found == times.end()) found = times.find(task.skill);
  return found == times.end() ? nullptr : &found->second;
}

void check_results(const std::map<std::string, SkillTime>& times, const Scenario& scenario, const FileFaults& faults) {
  std::map<std::string, std::string> takers;  // by whose value they take
  for (const Task& task : scenario.tasks) {
    for (const ValueFrom& from : task.values) takers.emplace(from.task, task.id);
  }
  std::size_t told = 0;
  for (const Task& task : scenario.tasks) {
    const auto taker = takers.find(task.id);
    if (taker == takers.end()) continue;
    const SkillTime* time = time_of(times, task);
    if (time != nullptr && !time->result.empty()) continue;
    const std::string key = std::string(kOfTask) + task.id;
    faults.add("times." + key + ".result",
               "is missing: task " + in_quotes(taker->second) + " takes a value from " + in_quotes(task.id),
               "say what its robot tells: \"times\": {\"" + key + "\": {\"mean\": 3, \"result\": ...}}");
    if (++told == kMostUnknown) return;
  }
}

}  // namespace

SkillTime read_usual_time(ObjectReader& reader) {
  SkillTime out;
  out.mean_s = reader.number("task_seconds", Need::optional, kSeconds).value_or(out.mean_s);
  out.deviation_s = reader.number("deviation", Need::optional, {0, out.mean_s}).value_or(0);
  return out;
}

std::map<std::string, SkillTime> read_times(ObjectReader& reader) {
  std::map<std::string, SkillTime> out;
  const Value::Object* times = reader.object("times", Need::optional, kMaxTimes);
  if (times == nullptr) return out;
  for (const auto& [skill, time] : *times) out[skill] = read_time("times." + skill, time, reader.faults());
  return out;
}

bool is_time_of(const std::string& name, const Scenario& scenario) {
  return std::ranges::any_of(
      scenario.tasks, [&](const Task& task) { return name == task.skill || name == std::string(kOfTask) + task.id; });
}

void check_times(const std::map<std::string, SkillTime>& times, const Scenario& scenario, const FileFaults& faults) {
  std::set<std::string> skills, tasks;
  for (const Task& task : scenario.tasks) {
    skills.insert(task.skill);
    tasks.insert(std::string(kOfTask) + task.id);
  }
  std::size_t told = 0;
  for (const auto& [name, time] : times) {
    const bool of_task = name.starts_with(kOfTask);
    const auto& known = of_task ? tasks : skills;
    if (known.contains(name)) continue;
    faults.add("times." + name,
               in_quotes(name) + (of_task ? " is no task of the scenario" : " is no skill of its tasks"),
               did_you_mean(name, {known.begin(), known.end()}, "leave it out, or use one of"));
    if (++told == kMostUnknown) return;
  }
  check_results(times, scenario, faults);
}

void check_times(const std::map<std::string, SkillTime>& times, const std::vector<const Scenario*>& scenarios,
                 const FileFaults& faults) {
  auto of_first = times;
  for (std::size_t i = 1; i < scenarios.size(); ++i) {
    auto of_run = times;
    std::erase_if(of_run, [&](const auto& time) { return !is_time_of(time.first, *scenarios[i]); });
    check_times(of_run, *scenarios[i], faults);
    for (const auto& [name, time] : of_run) {
      if (!is_time_of(name, *scenarios[0])) of_first.erase(name);
    }
  }
  check_times(of_first, *scenarios.at(0), faults);
}

}  // namespace trb::simulation
