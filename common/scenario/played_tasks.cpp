#include "common/scenario/played_tasks.hpp"

#include <algorithm>
#include <utility>

namespace trb {
namespace {

std::vector<std::string> ids_before(const Scenario& scenario, const Task& task) {
  std::vector<std::string> out;
  for (const std::uint16_t before : task.after) out.push_back(scenario.tasks[before].id);
  return out;
}

bool is_text(const Value* value) {
  return value != nullptr && value->is_text();
}

bool is_number(const Value* value) {
  return value != nullptr && value->is_number();
}

void add_attempt(const Value& one, const Scenario& scenario, std::vector<PlayedTask>& out) {
  if (!one.is_object()) return;
  const Value *id = one.find("id"), *robot = one.find("robot"), *begin = one.find("begin_s"), *end = one.find("end_s");
  if (!is_text(id) || !is_text(robot) || !is_number(begin) || !is_number(end)) return;
  const auto task = std::ranges::find(scenario.tasks, id->text(), &Task::id);
  if (task == scenario.tasks.end()) return;
  out.push_back({id->text(), robot->text(), begin->number(), end->number(), ids_before(scenario, *task)});
}

}  // namespace

std::vector<PlayedTask> played_tasks(const Value& answer, const Scenario& scenario) {
  std::vector<PlayedTask> out;
  const Value* tasks = answer.is_object() ? answer.find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return out;
  for (const Value& one : tasks->list()) add_attempt(one, scenario, out);
  std::ranges::stable_sort(out, {}, &PlayedTask::begin_s);
  const double first = out.empty() ? 0 : out.front().begin_s;
  for (PlayedTask& one : out) one.begin_s -= first, one.end_s -= first;
  return out;
}

Value waits_value(const std::vector<PlayedTask>& tasks) {
  const std::vector<TaskWait> waits = waits_of(tasks);
  Value::List out;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const auto& holder = waits[i].holder;
    out.push_back(Value{Value::Object{{"task", Value{tasks[i].id}},
                                      {"waited_for", Value{holder ? tasks[*holder].id : std::string()}},
                                      {"robot_busy", Value{waits[i].is_robot_busy}},
                                      {"critical", Value{waits[i].is_critical}}}});
  }
  return Value{std::move(out)};
}

}  // namespace trb
