#include "common/scenario/definition.hpp"

#include <utility>

#include "common/base/ids.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/scenario/condition_file.hpp"
#include "common/scenario/cycles.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxData = 65536;

std::string path_of(std::size_t index) {
  return "tasks[" + std::to_string(index) + "]";
}

/// A task with the names of its predecessors, which may stand further down in the file.
struct ReadTask {
  Task task;
  std::vector<std::string> after;
};

std::string read_data(ObjectReader& reader) {
  const Value* data = reader.value("data", Need::optional);
  if (data == nullptr) return {};
  if (!data->is_object()) {
    reader.faults().add(reader.path("data"), "is a " + std::string(data->kind()),
                        R"(write the skill's parameters as { "NAME": VALUE, … })");
    return {};
  }
  std::string text = dump_json(*data);
  if (text.size() <= kMaxData) return text;
  reader.faults().add(reader.path("data"), "is " + std::to_string(text.size()) + " bytes long",
                      "keep it to " + std::to_string(kMaxData));
  return {};
}

void check_words(const ObjectReader& reader, const Task& task) {
  const std::vector<std::pair<std::string, Status>> checks = {{"id", check_id("id", task.id)},
                                                              {"robot", check_id("robot", task.robot)}};
  for (const auto& [key, status] : checks) {
    const bool given = !(key == "id" ? task.id : task.robot).empty();
    if (given && !status) reader.faults().add(reader.path(key), status.error().what, status.error().cure);
  }
  if (task.skill.empty() || is_valid_word(task.skill)) return;
  reader.faults().add(reader.path("skill"), in_quotes(task.skill) + " is no name of a skill",
                      "use a letter, then letters, digits, '_' or '-', 64 at most");
}

/// A robot chosen late, by capability, is part of the format; refusing it here keeps it from being ignored.
void read_robot(ObjectReader& reader, Task& task) {
  const bool late = reader.value("requires", Need::optional) != nullptr;
  if (late) {
    reader.faults().add(reader.path("requires"), "is not carried out by this version yet",
                        "name the robot: \"robot\": \"ID\"");
  }
  task.robot = reader.text("robot", late ? Need::optional : Need::required).value_or("");
}

ReadTask read_task(const Value& json, std::size_t index, const FileFaults& faults) {
  ObjectReader reader(json, path_of(index), faults);
  ReadTask out;
  Task& task = out.task;
  task.id = reader.text("id", Need::required).value_or("");
  read_robot(reader, task);
  task.skill = reader.text("skill", Need::required).value_or("");
  task.data = read_data(reader);
  out.after = reader.texts("after", Need::optional, kMaxTasks);
  task.timeout_s = reader.number("timeout_s", Need::optional, {0, kSeconds.to}).value_or(0);
  task.pinned = reader.boolean("pinned", Need::optional).value_or(false);
  if (const Value* when = reader.value("when", Need::optional)) {
    task.when.push_back(read_condition(*when, reader.path("when"), faults));
  }
  reader.refuse_unknown_keys();
  check_words(reader, task);
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
        faults.add(path_of(i) + ".after", in_quotes(name) + " is no task",
                   did_you_mean(name, ids, "use ids of this scenario"));
      }
    }
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

}  // namespace

Scenario read_scenario(const Value& json, const std::string& file, ConfigFaults& faults) {
  const FileFaults sink(file, faults);
  ObjectReader reader(json, "", sink);
  Scenario scenario;
  scenario.name = reader.text("name", Need::required, 64).value_or("");
  scenario.description = reader.text("description", Need::optional, 4096).value_or("");
  std::vector<ReadTask> tasks = read_tasks(reader);
  reader.refuse_unknown_keys();
  const Index index = index_tasks(tasks, sink);
  link(tasks, index, sink);
  for (ReadTask& read : tasks) scenario.tasks.push_back(std::move(read.task));
  check_cycles(scenario, sink);
  return scenario;
}

}  // namespace trb
