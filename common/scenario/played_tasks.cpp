#include "common/scenario/played_tasks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
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

namespace {

/// nullptr: it has none.
const Value* run_of(const Value& answer, std::size_t run) {
  const Value* beside = answer.is_object() && run > 0 ? answer.find("beside") : nullptr;
  if (run == 0) return answer.is_object() ? &answer : nullptr;
  return beside != nullptr && beside->is_list() && run <= beside->list().size() ? &beside->list()[run - 1] : nullptr;
}

/// In the simulation's time; 0: the answer does not say.
double submitted_s(const Value& answer, std::size_t run) {
  const Value* of = run_of(answer, run);
  if (of != nullptr && run == 0) of = of->find("world");
  const Value* at = of != nullptr && of->is_object() ? of->find("submitted_s") : nullptr;
  return is_number(at) ? at->number() : 0;
}

std::vector<PlayedTask> attempts_of(const Value& answer, std::size_t run, const Scenario& scenario) {
  const Value* of = run_of(answer, run);
  const Value* tasks = of != nullptr && of->is_object() ? of->find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return {};
  std::vector<PlayedTask> out;
  for (const Value& one : tasks->list()) {
    if (auto attempt = attempt_of(one, scenario)) out.push_back(std::move(*attempt));
  }
  std::ranges::stable_sort(out, {}, &PlayedTask::begin_s);
  drop_others(out);
  const Before before(scenario, out);
  for (PlayedTask& one : out) {
    one.after = before.of(one.id);
    one.run = run;
    one.since_s = submitted_s(answer, run);
  }
  return out;
}

}  // namespace

std::vector<PlayedTask> played_tasks(const Value& answer, const std::vector<Scenario>& scenarios) {
  std::vector<PlayedTask> out;
  for (std::size_t run = 0; run < scenarios.size(); ++run) {
    std::ranges::move(attempts_of(answer, run, scenarios[run]), std::back_inserter(out));
  }
  std::ranges::stable_sort(out, {}, &PlayedTask::begin_s);
  const double first = out.empty() ? 0 : out.front().begin_s;
  for (PlayedTask& one : out) {
    one.begin_s -= first, one.end_s -= first;
    one.since_s = std::max(0.0, one.since_s - first);
  }
  return out;
}

std::vector<PlayedTask> played_tasks(const Value& answer, const Scenario& scenario) {
  return played_tasks(answer, std::vector{scenario});
}

Value waits_value(const std::vector<PlayedTask>& tasks, std::size_t run) {
  const std::vector<TaskWait> waits = waits_of(tasks);
  Value::List out;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].is_dropped || tasks[i].run != run) continue;
    const auto& holder = waits[i].holder;
    const bool is_of_other = holder && tasks[*holder].run != run;
    Value::Object row{{"task", Value{tasks[i].id}},
                      {"waited_for", Value{holder ? tasks[*holder].id : std::string()}},
                      {"robot_busy", Value{waits[i].is_robot_busy}},
                      {"critical", Value{waits[i].is_critical}},
                      {"tried_again", Value{holder && !is_of_other && tasks[*holder].id == tasks[i].id}},
                      {"more_s", Value{in_milliseconds(waits[i].more_s)}}};
    if (is_of_other) {
      row.emplace_back("waited_for_run", Value{static_cast<std::int64_t>(tasks[*holder].run)});
      row.emplace_back("kept_s", Value{in_milliseconds(waits[i].kept_s)});
    }
    out.push_back(Value{std::move(row)});
  }
  return Value{std::move(out)};
}

void add_waits(Value& answer, const std::vector<Scenario>& scenarios) {
  if (!answer.is_object()) return;
  const std::vector<PlayedTask> tasks = played_tasks(answer, scenarios);
  auto& members = std::get<Value::Object>(answer.is);
  for (auto& [key, value] : members) {
    if (key != "beside" || !value.is_list()) continue;
    auto& runs = std::get<Value::List>(value.is);
    for (std::size_t i = 0; i < runs.size() && i + 1 < scenarios.size(); ++i) {
      if (runs[i].is_object()) std::get<Value::Object>(runs[i].is).emplace_back("waits", waits_value(tasks, i + 1));
    }
  }
  members.emplace_back("waits", waits_value(tasks));
}

}  // namespace trb
