#include "common/scenario/graph.hpp"

#include <algorithm>
#include <set>

#include "common/base/ids.hpp"
#include "common/scenario/condition.hpp"
#include "common/scenario/repeat.hpp"

namespace trb {
namespace {

Error wrong(Errc code, const Task& task, const std::string& what, std::string hint = {}) {
  return fail(code, "task '" + task.id + "': " + what, std::move(hint));
}

Status check_id_and_robot(const Task& task) {
  if (!is_valid_task_id(task.id)) return check_id("task", task.id);
  if (!task.robot.empty() || !task.requires_.empty()) return Done{};
  return wrong(Errc::bad_value, task, "has no robot", "name one, or capabilities: \"requires\"");
}

Status check_retries(const Task& task) {
  const bool in_time = task.retry_after_s >= kMinRetryAfterS && task.retry_after_s <= kMaxRetryAfterS;
  if (task.retries <= kMaxRetries && in_time) return Done{};
  return wrong(Errc::bad_value, task, "retries out of bounds", "16 at most, after 0.1 s to 3600 s");
}

Status check_start(const Task& task) {
  const bool in_time = task.start_within_s >= kMinStartWithinS && task.start_within_s <= kMaxStartWithinS;
  if (task.start_within_s == 0 || in_time) return Done{};
  return wrong(Errc::bad_value, task, "start_within_s out of bounds", "0.1 s to 86400 s, or 0: it waits");
}

/// Its predecessors must have been checked.
Status check_values(const Scenario& scenario, const Task& task) {
  std::set<std::string> seen;
  for (const ValueFrom& value : task.values) {
    const auto gives = [&](TaskIndex before) { return scenario.tasks[before].id == value.task; };
    if (std::none_of(task.after.begin(), task.after.end(), gives)) {
      return wrong(Errc::bad_value, task, "'" + value.parameter + "' is from '" + value.task + "', no predecessor",
                   "add it to the predecessors");
    }
    if (seen.insert(value.parameter).second) continue;
    return wrong(Errc::duplicate, task, "'" + value.parameter + "' has two values");
  }
  return Done{};
}

Status check_task(const Scenario& scenario, std::size_t index, std::set<std::string>& ids) {
  const Task& task = scenario.tasks[index];
  if (auto begun = check_id_and_robot(task); !begun) return begun;
  if (!ids.insert(task.id).second) return fail(Errc::duplicate, "task '" + task.id + "' occurs twice", "rename one");
  std::set<TaskIndex> seen;
  for (const TaskIndex before : task.after) {
    if (before >= scenario.tasks.size() || before == index) {
      return fail(Errc::bad_value,
                  "task '" + task.id + "': predecessor " + std::to_string(before) + " is no other task");
    }
    if (!seen.insert(before).second) {
      return fail(Errc::duplicate, "task '" + task.id + "': predecessor " + std::to_string(before) + " occurs twice");
    }
  }
  if (task.when.size() > 1) return fail(Errc::bad_value, "task '" + task.id + "' has more than one condition");
  for (const Condition& condition : task.when) {
    if (auto checked = check_condition(condition); !checked) {
      return fail(Errc::bad_value, "task '" + task.id + "': " + checked.error().what, checked.error().hint);
    }
  }
  if (auto retries = check_retries(task); !retries) return retries;
  if (auto start = check_start(task); !start) return start;
  return check_values(scenario, task);
}

/// Kahn's algorithm: a task that cannot be removed is on a cycle or behind one.
Status check_acyclic(const Scenario& scenario) {
  const auto successors = successors_of(scenario);
  std::vector<std::size_t> open(scenario.tasks.size());
  std::vector<TaskIndex> free;
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i] = scenario.tasks[i].after.size();
    if (open[i] == 0) free.push_back(static_cast<TaskIndex>(i));
  }
  std::size_t taken = 0;
  for (; taken < free.size(); ++taken) {
    for (const TaskIndex next : successors[free[taken]]) {
      if (--open[next] == 0) free.push_back(next);
    }
  }
  if (taken == open.size()) return Done{};
  const auto stuck = std::find_if(open.begin(), open.end(), [](std::size_t count) { return count != 0; });
  return fail(
      Errc::bad_value,
      "task '" + scenario.tasks[static_cast<std::size_t>(stuck - open.begin())].id + "' waits for a cycle of tasks",
      "remove one predecessor of the cycle");
}

}  // namespace

Status check_graph(const Scenario& scenario) {
  if (scenario.tasks.empty()) return fail(Errc::bad_value, "the scenario has no task");
  if (scenario.tasks.size() > kMaxTasks)
    return fail(Errc::too_large, "more than " + std::to_string(kMaxTasks) + " tasks");
  std::set<std::string> ids;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    if (auto task = check_task(scenario, i, ids); !task) return task;
  }
  return check_acyclic(scenario);
}

std::vector<std::vector<TaskIndex>> successors_of(const Scenario& scenario) {
  std::vector<std::vector<TaskIndex>> out(scenario.tasks.size());
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    for (const TaskIndex before : scenario.tasks[i].after) out[before].push_back(static_cast<TaskIndex>(i));
  }
  return out;
}

TaskIndex chooser_of(const Scenario& scenario, TaskIndex task) {
  const auto& after = scenario.tasks[task].after;
  return after.empty() ? task : *std::min_element(after.begin(), after.end());
}

bool predecessors_final(const Task& task, const std::vector<bool>& final_tasks) {
  return std::all_of(task.after.begin(), task.after.end(), [&](TaskIndex before) { return final_tasks[before]; });
}

Bytes to_bitmap(const std::vector<bool>& final_tasks) {
  Bytes out((final_tasks.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < final_tasks.size(); ++i) {
    if (!final_tasks[i]) continue;
    out[i / 8] = static_cast<char>(static_cast<unsigned char>(out[i / 8]) | (1U << (i % 8)));
  }
  out.resize(out.find_last_not_of('\0') + 1);  // npos + 1 is 0
  return out;
}

Result<std::vector<bool>> from_bitmap(BytesView bitmap, std::size_t tasks) {
  std::vector<bool> out(tasks, false);
  for (std::size_t i = 0; i < bitmap.size() * 8; ++i) {
    if ((static_cast<unsigned char>(bitmap[i / 8]) >> (i % 8) & 1U) == 0) continue;
    if (i >= tasks) return fail(Errc::too_large, "final_tasks: bit " + std::to_string(i) + " is beyond the last task");
    out[i] = true;
  }
  return out;
}

Blocks blocks_of(const std::vector<std::string>& robots) {
  Blocks blocks;
  for (std::size_t i = 0; i < robots.size();) {
    std::size_t end = i + 1;
    while (end < robots.size() && robots[end] == robots[i]) ++end;
    if (end - i > 1) {
      ++blocks.k;
      blocks.sum_m += end - i;
    }
    i = end;
  }
  return blocks;
}

std::size_t forward_messages(const std::vector<std::string>& robots) {
  if (robots.empty()) return 0;
  const Blocks blocks = blocks_of(robots);
  return robots.size() - blocks.sum_m + blocks.k - 1;
}

}  // namespace trb
