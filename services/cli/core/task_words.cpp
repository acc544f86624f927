#include "services/cli/core/task_words.hpp"

#include <algorithm>
#include <cstdio>

#include "common/base/time.hpp"
#include "services/cli/core/table.hpp"

namespace trb::cli {
namespace {

/// The view tells of this attempt.
bool is_shown(const TaskView& task, const TaskResult& result) {
  return result.key.attempt == task.attempt && result.started == task.started && result.ended == task.ended;
}

}  // namespace

std::string time_or_dash(std::int64_t ns) {
  return ns == 0 ? "-" : to_iso8601({ns});
}

std::string took_text(double s) {
  char out[32];
  std::snprintf(out, sizeof out, "%.2f s", s);
  return out;
}

std::string state_word(const TaskView& task) {
  if (task.state != TaskState::retriable) return std::string(name_of(task.state));
  return task.outcome == TaskOutcome::interrupted ? "INTERRUPTED" : "NOT DONE";
}

std::string robot_of(const TaskView& task, const std::vector<TaskResult>& doers) {
  const auto shown = std::ranges::find_if(doers, [&](const TaskResult& one) { return is_shown(task, one); });
  return or_dash(shown == doers.end() ? task.robot : shown->robot);
}

std::string why_of(const TaskView& task, const std::vector<TaskResult>& doers) {
  std::string out = task.reason;
  const auto add = [&](const std::string& more) { out += (out.empty() ? "" : "; ") + more; };
  if (!task.waits_for.empty()) add("waits for " + task.waits_for);
  if (doers.size() > 1) {
    for (const TaskResult& one : doers) {
      if (is_shown(task, one)) continue;
      add("done twice, also by " + one.robot + ": attempt " + std::to_string(one.key.attempt) + ", began " +
          time_or_dash(one.started) + ", took " + took_text(one.duration_s));
    }
  } else if (task.twice) {
    add("done twice");
  }
  if (!task.condition.empty()) add("when " + task.condition);
  if (!task.moved_from.empty()) add("was " + task.moved_from + "'s");
  for (const std::string& robot : task.failed_by) add("tried by " + robot);
  return out;
}

}  // namespace trb::cli
