#include "common/scenario/played_tasks.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace trb {
namespace {

bool is_text(const Value* value) {
  return value != nullptr && value->is_text();
}

bool is_number(const Value* value) {
  return value != nullptr && value->is_number();
}

/// Of one attempt that was done, or has failed.
std::optional<PlayedTask> attempt_of(const Value& one, const Scenario& scenario) {
  if (!one.is_object()) return std::nullopt;
  const Value *id = one.find("id"), *robot = one.find("robot"), *begin = one.find("begin_s"), *end = one.find("end_s");
  const bool has_failed = end == nullptr;
  if (has_failed) end = one.find("failed_s");
  if (!is_text(id) || !is_text(robot) || !is_number(begin) || !is_number(end)) return std::nullopt;
  if (std::ranges::find(scenario.tasks, id->text(), &Task::id) == scenario.tasks.end()) return std::nullopt;
  return PlayedTask{id->text(), robot->text(), begin->number(), end->number(), {}, has_failed};
}

/// Those that were done; of a task that never was, its last one.
std::vector<PlayedTask> attempts_that_count(const Value::List& tasks, const Scenario& scenario) {
  std::vector<PlayedTask> out;
  std::map<std::string, PlayedTask> failed;
  std::set<std::string> done;
  for (const Value& one : tasks) {
    auto attempt = attempt_of(one, scenario);
    if (!attempt) continue;
    if (attempt->has_failed) {
      failed.insert_or_assign(attempt->id, std::move(*attempt));
    } else {
      done.insert(attempt->id);
      out.push_back(std::move(*attempt));
    }
  }
  for (auto& [id, attempt] : failed) {
    if (!done.contains(id)) out.push_back(std::move(attempt));
  }
  return out;
}

/// What comes before each task, among those that were played: who comes behind one that was skipped waits for what
/// that one waits for.
class Before {
 public:
  Before(const Scenario& scenario, const std::vector<PlayedTask>& played) : scenario_(scenario) {
    for (const PlayedTask& one : played) played_.insert(one.id);
  }

  std::vector<std::string> of(const std::string& id) const {
    std::vector<std::string> out;
    const auto task = std::ranges::find(scenario_.tasks, id, &Task::id);
    std::vector<std::uint16_t> next(task->after.rbegin(), task->after.rend());
    std::set<std::uint16_t> seen;
    while (!next.empty()) {
      const std::uint16_t at = next.back();
      next.pop_back();
      if (!seen.insert(at).second) continue;
      const Task& before = scenario_.tasks[at];
      if (played_.contains(before.id)) {
        out.push_back(before.id);
      } else {
        next.insert(next.end(), before.after.rbegin(), before.after.rend());
      }
    }
    return out;
  }

 private:
  const Scenario& scenario_;
  std::set<std::string> played_;
};

}  // namespace

std::vector<PlayedTask> played_tasks(const Value& answer, const Scenario& scenario) {
  const Value* tasks = answer.is_object() ? answer.find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return {};
  std::vector<PlayedTask> out = attempts_that_count(tasks->list(), scenario);
  std::ranges::stable_sort(out, {}, &PlayedTask::begin_s);
  const Before before(scenario, out);
  const double first = out.empty() ? 0 : out.front().begin_s;
  for (PlayedTask& one : out) {
    one.begin_s -= first, one.end_s -= first;
    one.after = before.of(one.id);
  }
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
