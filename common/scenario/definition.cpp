#include "common/scenario/definition.hpp"

#include <utility>

#include "common/base/ids.hpp"
#include "common/base/words.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/condition_file.hpp"
#include "common/scenario/cycles.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/repeat.hpp"
#include "common/scenario/task_data.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxScenario = DecodeLimits{}.bytes / 2;
constexpr std::size_t kMaxRequires = 32;  ///< as Task::requires_
constexpr std::size_t kMaxGuesses = 20;
constexpr std::string_view kWordCure = "use a letter, then letters, digits, '_' or '-', 64 at most";

std::string path_of(std::size_t index) {
  return "tasks[" + std::to_string(index) + "]";
}

/// A task with the names of its predecessors, which may come later in the file.
struct ReadTask {
  Task task;
  std::vector<std::string> after;
};

/// An optional text that must be a valid name.
std::string read_word(ObjectReader& reader, std::string_view key, Need need) {
  const auto id = reader.text(key, need);
  if (!id) return {};
  if (auto checked = check_id(key, *id); !checked) {
    reader.faults().add(reader.path(key), checked.error().what, checked.error().hint);
  }
  return *id;
}

std::string read_skill(ObjectReader& reader) {
  const auto skill = reader.text("skill", Need::required);
  if (!skill) return {};
  if (!is_valid_word(*skill)) {
    reader.faults().add(reader.path("skill"), in_quotes(*skill) + " is no name of a skill", std::string(kWordCure));
  }
  return *skill;
}

/// By name, or bound late: to a robot with the capabilities.
void read_robot(ObjectReader& reader, Task& task) {
  const Value* late = reader.value("requires", Need::optional);
  task.requires_ = reader.texts("requires", Need::optional, kMaxRequires);
  for (const std::string& capability : task.requires_) {
    if (is_valid_word(capability)) continue;
    reader.faults().add(reader.path("requires"), in_quotes(capability) + " is no capability", std::string(kWordCure));
  }
  if (late != nullptr && late->is_list() && late->list().empty()) {
    reader.faults().add(reader.path("requires"), "is empty",
                        R"(name a capability, or leave it out and name the robot: "robot": "ID")");
  }
  task.robot = read_word(reader, "robot", late != nullptr ? Need::optional : Need::required);
}

void read_failure(ObjectReader& reader, Task& task) {
  const auto retries = reader.integer("retries", Need::optional, 0, kMaxRetries);
  task.retries = static_cast<std::uint32_t>(retries.value_or(0));
  task.retry_after_s =
      reader.number("retry_after_s", Need::optional, {kMinRetryAfterS, kMaxRetryAfterS}).value_or(task.retry_after_s);
  task.on_failure = reader.one_of<OnFailure>("on_failure", Need::optional).value_or(task.on_failure);
  task.start_within_s =
      reader.number("start_within_s", Need::optional, {kMinStartWithinS, kMaxStartWithinS}).value_or(0);
}

ReadTask read_task(const Value& json, std::size_t index, const FileFaults& faults) {
  ObjectReader reader(json, path_of(index), faults);
  ReadTask out;
  Task& task = out.task;
  task.id = read_word(reader, "id", Need::required);
  read_robot(reader, task);
  task.skill = read_skill(reader);
  read_data(reader, task);
  out.after = reader.texts("after", Need::optional, kMaxTasks);
  task.timeout_s = reader.number("timeout_s", Need::optional, {0, kSeconds.to}).value_or(0);
  task.pinned = reader.boolean("pinned", Need::optional).value_or(false);
  read_failure(reader, task);
  if (const Value* when = reader.value("when", Need::optional)) {
    task.when.push_back(read_condition(*when, reader.path("when"), faults));
  }
  reader.refuse_unknown_keys();
  return out;
}

/// The index of each id; of ids that occur twice, the first.
using Index = std::map<std::string, std::size_t>;

Index index_tasks(const std::vector<ReadTask>& tasks, const FileFaults& faults) {
  Index index;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string& id = tasks[i].task.id;
    const auto [first, is_new] = index.emplace(id, i);
    if (is_new || id.empty()) continue;
    faults.add(path_of(i) + ".id", in_quotes(id) + " is already the id of " + path_of(first->second),
               "give each task an id of its own");
  }
  return index;
}

/// What was probably meant is looked for among all ids, and so only for the first faults of a file.
std::string cure_of(const std::string& name, const std::vector<std::string>& ids, const FileFaults& faults) {
  const std::string otherwise = "use ids of this scenario";
  return faults.count() < kMaxGuesses ? did_you_mean(name, ids, otherwise) : otherwise + ": " + join(ids);
}

/// A value can come only from a predecessor, whose result comes with the baton.
void check_sources(const ReadTask& read, std::size_t at, const std::vector<std::string>& ids,
                   const FileFaults& faults) {
  for (const ValueFrom& value : read.task.values) {
    if (contains(read.after, value.task) || faults.full()) continue;
    const std::string key = path_of(at) + ".data." + value.parameter + ".from";
    if (value.task == read.task.id) {
      faults.add(key, "is the task itself", "name a task that comes before");
    } else if (contains(ids, value.task)) {
      faults.add(key, in_quotes(value.task) + " is not among the tasks that it waits for",
                 "add \"" + value.task + "\" to its \"after\"");
    } else {
      faults.add(key, in_quotes(value.task) + " is no task", cure_of(value.task, ids, faults));
    }
  }
}

/// Turns the names of the predecessors into indexes.
void link(std::vector<ReadTask>& tasks, const Index& index, const FileFaults& faults) {
  std::vector<std::string> ids;
  ids.reserve(tasks.size());
  for (const ReadTask& read : tasks) ids.push_back(read.task.id);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (const std::string& name : tasks[i].after) {
      const auto at = index.find(name);
      if (at != index.end()) {
        tasks[i].task.after.push_back(static_cast<std::uint16_t>(at->second));
      } else if (!faults.full()) {
        faults.add(path_of(i) + ".after", in_quotes(name) + " is no task", cure_of(name, ids, faults));
      }
    }
    check_sources(tasks[i], i, ids, faults);
  }
}

void check_cycles(const Scenario& scenario, const FileFaults& faults) {
  for (const std::vector<std::size_t>& cycle : find_cycles(scenario)) {
    std::string names;
    for (const std::size_t index : cycle) names += scenario.tasks[index].id + " -> ";
    names += scenario.tasks[cycle.front()].id;
    faults.add(path_of(cycle.front()) + ".after", "the tasks wait for each other in a circle: " + names,
               "remove one of them from the other's \"after\"");
  }
}

std::vector<ReadTask> read_tasks(ObjectReader& reader) {
  std::vector<ReadTask> tasks;
  const auto* items = reader.list("tasks", Need::required, kMaxTasks);
  if (items == nullptr) return tasks;
  if (items->empty()) reader.faults().add("tasks", "is empty", R"(add a task: {"id": …, "robot": …, "skill": …})");
  for (std::size_t i = 0; i < items->size(); ++i) tasks.push_back(read_task((*items)[i], i, reader.faults()));
  return tasks;
}

void check_repeated_ids(const std::vector<ReadTask>& tasks, std::uint32_t rounds, const FileFaults& faults) {
  const std::size_t room = kMaxIdSize + 1 - round_id(" ", rounds).size();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string& id = tasks[i].task.id;
    if (id.size() <= room || id.size() > kMaxIdSize) continue;
    faults.add(path_of(i) + ".id", "has no room for the number of its round, as in " + in_quotes("ID#2"),
               "keep it to " + std::to_string(room) + " bytes");
  }
}

std::uint32_t read_repeat(ObjectReader& reader, const std::vector<ReadTask>& tasks) {
  const auto rounds = static_cast<std::uint32_t>(reader.integer("repeat", Need::optional, 1, kMaxRounds).value_or(1));
  const std::size_t all = rounds * tasks.size();
  if (all > kMaxTasks) {
    const std::string most = std::to_string(kMaxTasks);
    reader.faults().add(
        "repeat", "makes " + std::to_string(all) + " tasks of " + std::to_string(tasks.size()),
        "use at most " + std::to_string(kMaxTasks / tasks.size()) + ": a scenario has " + most + " tasks at most");
  }
  check_repeated_ids(tasks, rounds, reader.faults());
  return rounds;
}

/// A run's start is one message, which also carries its members' certificates.
void check_size(const Scenario& scenario, const FileFaults& faults) {
  const std::size_t size = encode(scenario).size();
  if (size <= kMaxScenario) return;
  faults.add("tasks", "are " + std::to_string(size) + " bytes long when they are sent",
             "keep them to " + std::to_string(kMaxScenario) +
                 ": fewer rounds, shorter data, or one task that waits for many in place of many that do");
}

}  // namespace

void warn_of_skips(const Scenario& scenario, const std::string& file, ConfigFaults& faults) {
  const auto successors = successors_of(scenario);
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const Task& task = scenario.tasks[i];
    if (task.on_failure != OnFailure::skip || is_repetition(task.id)) continue;
    std::string names;
    for (const TaskIndex next : successors[i]) {
      const Task& after = scenario.tasks[next];
      if (after.after.size() == 1 && !is_repetition(after.id))
        names += (names.empty() ? "" : ", ") + in_quotes(after.id);
    }
    if (names.empty() || faults.size() >= kMaxWarnings) continue;
    faults.push_back({file, path_of(i) + ".on_failure",
                      "task " + in_quotes(task.id) + " is skipped when it fails, and then " + names + " too",
                      R"(say on_failure "continue" if that shall go on)", true});
  }
}

Scenario read_scenario(const Value& json, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  Scenario scenario;
  scenario.name = reader.text("name", Need::required, 64).value_or("");
  scenario.description = reader.text("description", Need::optional, 4096).value_or("");
  std::vector<ReadTask> tasks = read_tasks(reader);
  const std::uint32_t rounds = read_repeat(reader, tasks);
  reader.refuse_unknown_keys();
  const Index index = index_tasks(tasks, sink);
  link(tasks, index, sink);
  for (ReadTask& read : tasks) scenario.tasks.push_back(std::move(read.task));
  check_cycles(scenario, sink);
  if (!faults.empty()) return scenario;
  scenario.tasks = repeat_tasks(scenario.tasks, rounds);
  check_size(scenario, sink);
  return scenario;
}

}  // namespace trb
