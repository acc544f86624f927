#include "common/scenario/played_tasks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

double in_milliseconds(double time_s) {
  return std::round(time_s * 1e3) / 1e3;
}

std::optional<PlayedTask> attempt_of(const Value& one, const Scenario& scenario) {
  if (!one.is_object()) return std::nullopt;
  const Value *id = one.find("id"), *robot = one.find("robot"), *begin = one.find("begin_s");
  if (!is_text(id) || !is_text(robot) || !is_number(begin)) return std::nullopt;
  if (std::ranges::find(scenario.tasks, id->text(), &Task::id) == scenario.tasks.end()) return std::nullopt;
  const Value *done = one.find("end_s"), *failed = one.find("failed_s");
  const Value* end = done != nullptr ? done : failed;
  if (end != nullptr && !is_number(end)) return std::nullopt;
  return PlayedTask{.id = id->text(),
                    .robot = robot->text(),
                    .begin_s = begin->number(),
                    .end_s = end != nullptr ? end->number() : std::numeric_limits<double>::infinity(),
                    .after = {},
                    .has_failed = done == nullptr && failed != nullptr,
                    .is_open = end == nullptr};
}

/// Those that were done count; of a task that never was, its last one that has failed.
void drop_others(std::vector<PlayedTask>& attempts) {
  std::map<std::string, PlayedTask*> failed;
  std::set<std::string> done;
  for (PlayedTask& one : attempts) {
    if (one.has_failed) failed[one.id] = &one;
    if (!one.has_failed && !one.is_open) done.insert(one.id);
  }
  for (PlayedTask& one : attempts) {
    const auto at = failed.find(one.id);
    const bool is_last = at != failed.end() && at->second == &one;
    one.is_dropped = one.is_open || (one.has_failed && (done.contains(one.id) || !is_last));
  }
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
  std::vector<PlayedTask> out;
  for (const Value& one : tasks->list()) {
    if (auto attempt = attempt_of(one, scenario)) out.push_back(std::move(*attempt));
  }
  std::ranges::stable_sort(out, {}, &PlayedTask::begin_s);
  drop_others(out);
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
    if (tasks[i].is_dropped) continue;
    const auto& holder = waits[i].holder;
    out.push_back(Value{Value::Object{{"task", Value{tasks[i].id}},
                                      {"waited_for", Value{holder ? tasks[*holder].id : std::string()}},
                                      {"robot_busy", Value{waits[i].is_robot_busy}},
                                      {"critical", Value{waits[i].is_critical}},
                                      {"tried_again", Value{holder && tasks[*holder].id == tasks[i].id}},
                                      {"more_s", Value{in_milliseconds(waits[i].more_s)}}}});
  }
  return Value{std::move(out)};
}

}  // namespace trb
