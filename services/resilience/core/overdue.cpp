#include "services/resilience/core/overdue.hpp"

#include <algorithm>

namespace trb::resilience {
namespace {

bool is_held(const WatchedRun& run) {
  return !run.view->paused_by.empty();
}

std::string seconds_text(Duration time) {
  return std::to_string(time / std::chrono::seconds(1)) + " s";
}

bool does_without(const Task& task) {
  return task.on_failure == OnFailure::skip || task.on_failure == OnFailure::continue_;
}

}  // namespace

Overdue::Phase Overdue::phase_of(const WatchedRun& run, std::size_t index) {
  const TaskView& task = run.view->tasks[index];
  if (task.robot.empty() || task.outcome != TaskOutcome::none) return Phase::none;
  if (task.state == TaskState::initializing || task.state == TaskState::running) return Phase::begun;
  return task.due && task.state == TaskState::waiting && !is_held(run) ? Phase::due : Phase::none;
}

void Overdue::follow(const WatchedRun& run, const std::set<std::string>& told, Now now) {
  const bool is_new = !runs_.contains(run.summary.run);
  std::map<std::size_t, Entry>& entries = runs_[run.summary.run];
  for (std::size_t i = 0; i < run.view->tasks.size() && i < run.start->scenario.tasks.size(); ++i) {
    const TaskView& task = run.view->tasks[i];
    const Phase phase = phase_of(run, i);
    const auto at = entries.find(i);
    if (phase == Phase::none) {
      if (at != entries.end()) entries.erase(at);
      continue;
    }
    const bool same = at != entries.end() && at->second.phase == phase && at->second.robot == task.robot &&
                      at->second.attempt == task.attempt;
    if (!same) entries[i] = {phase, task.robot, task.attempt, now.mono, is_new && told.contains(task.id)};
  }
}

void Overdue::forget(std::string_view run) {
  if (const auto at = runs_.find(run); at != runs_.end()) runs_.erase(at);
}

/// How long it may stay in its phase; nothing: for ever.
std::optional<Duration> Overdue::limit(const WatchedRun& run, std::size_t index, const Entry& entry,
                                       const Fleet& fleet) {
  constexpr double kLongest_s = 1e9;
  const Task& task = run.start->scenario.tasks[index];
  if (entry.phase == Phase::due) {
    return task.start_within_s > 0 ? seconds(std::min(task.start_within_s, kLongest_s)) + kRule : kStart;
  }
  const RobotRecord* robot = fleet.find(entry.robot);
  const SkillInfo* skill = robot == nullptr ? nullptr : find_skill(*robot, task.skill);
  const double timeout_s = task.timeout_s > 0 ? task.timeout_s : skill == nullptr ? 0 : skill->timeout_s;
  if (!(timeout_s > 0)) return std::nullopt;
  const Duration timeout = seconds(std::min(timeout_s, kLongest_s));
  return timeout + std::max(kMargin, timeout / 2);
}

std::string Overdue::text_of(const WatchedRun& run, std::size_t index, const Entry& entry, Duration limit) {
  const TaskView& task = run.view->tasks[index];
  const std::string name = "task '" + task.id + "' ";
  if (entry.phase == Phase::begun)
    return name + "runs at " + task.robot + " for more than " + seconds_text(limit) + ", past its time-out";
  return name + "is due for " + seconds_text(limit) + " and " + task.robot + " has not begun it" +
         (task.waits_for.empty() ? "" : ": it waits for " + task.waits_for);
}

std::vector<Overdue::Late> Overdue::late(const WatchedRun& run, const Fleet& fleet) const {
  std::vector<Late> out;
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end() || is_held(run)) return out;
  for (const auto& [index, entry] : entries->second) {
    const auto most = limit(run, index, entry, fleet);
    const bool is_late = most && (entry.told || run.view_as_of - entry.since >= *most);
    if (is_late) out.push_back({index, text_of(run, index, entry, *most)});
  }
  return out;
}

std::vector<std::size_t> Overdue::to_skip(const WatchedRun& run) const {
  std::vector<std::size_t> out;
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end() || is_held(run)) return out;
  for (const auto& [index, entry] : entries->second) {
    const Task& task = run.start->scenario.tasks[index];
    if (entry.phase != Phase::due || entry.ruled || !(task.start_within_s > 0) || !does_without(task)) continue;
    if (run.view_as_of - entry.since >= seconds(task.start_within_s) + kRule) out.push_back(index);
  }
  return out;
}

bool Overdue::wants_view(const WatchedRun& run, const Fleet& fleet, Now now) const {
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end() || is_held(run)) return false;
  return std::ranges::any_of(entries->second, [&](const auto& one) {
    const auto most = limit(run, one.first, one.second, fleet);
    return most && now.mono - one.second.since >= *most && run.view_as_of - one.second.since < *most;
  });
}

void Overdue::ruled(const WatchedRun& run, std::size_t task) {
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end()) return;
  if (const auto at = entries->second.find(task); at != entries->second.end()) at->second.ruled = true;
}

std::optional<MonotonicTime> Overdue::next(const WatchedRun& run, const Fleet& fleet, Now now) const {
  std::optional<MonotonicTime> out;
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end()) return out;
  for (const auto& [index, entry] : entries->second) {
    const auto most = limit(run, index, entry, fleet);
    if (most && entry.since + *most > now.mono) out = earlier(out, entry.since + *most);
  }
  return out;
}

}  // namespace trb::resilience
