#include "services/resilience/core/overdue.hpp"

#include <algorithm>
#include <utility>

namespace trb::resilience {
namespace {

constexpr double kLongest_s = 1e9;

bool is_held(const WatchedRun& run) {
  return !run.view->paused_by.empty();
}

std::string seconds_text(Duration time) {
  return std::to_string(time / std::chrono::seconds(1)) + " s";
}

bool works_in(const WatchedRun& run, const std::string& robot) {
  return std::ranges::any_of(run.view->tasks, [&](const TaskView& one) {
    const bool is_under_way = one.state == TaskState::initializing || one.state == TaskState::running;
    return one.robot == robot && one.outcome == TaskOutcome::none && is_under_way;
  });
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

/// By the run's view, or by who controls the robot: what it was ordered last, and 10 s more. That is the robot's own
/// word: it is believed for ever only if the other run is open here, too, and has a task of the robot under way.
bool Overdue::does_another(const WatchedRun& run, std::size_t index, const Runs& runs, const Fleet& fleet, Entry& entry,
                           Now now) {
  const std::string& robot = run.view->tasks[index].robot;
  if (works_in(run, robot)) return true;
  const RobotRecord* record = fleet.find(robot);
  constexpr std::string_view kOfRun = "run ";
  const std::string_view control = record == nullptr ? std::string_view() : record->profile.is.control;
  if (!control.starts_with(kOfRun)) return false;
  const std::string_view other = control.substr(kOfRun.size());
  if (other == run.summary.run) return false;
  const auto known = runs.find(other);
  if (known != runs.end() && known->second.view && works_in(known->second, robot)) return true;
  // Since it first said so: who says it again and again is believed no longer than who says it all the time.
  if (!entry.claims_since) entry.claims_since = now.mono;
  return now.mono < *entry.claims_since + kBelieved;
}

void Overdue::follow(const WatchedRun& run, const std::set<std::string>& told, const Runs& runs, const Fleet& fleet,
                     Now now) {
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
    if (!same) {
      entries[i] = {phase, task.robot, task.attempt, now.mono,    is_new && told.contains(task.id),
                    false, false,      now.mono,     std::nullopt};
    }
    Entry& entry = entries[i];
    const bool works = phase == Phase::due && does_another(run, i, runs, fleet, entry, now);
    if (std::exchange(entry.robot_works, works) && !works) entry.free_since = now.mono;
  }
}

void Overdue::forget(std::string_view run) {
  if (const auto at = runs_.find(run); at != runs_.end()) runs_.erase(at);
}

/// How long it may stay in its phase; nothing: for ever.
std::optional<Duration> Overdue::limit(const WatchedRun& run, std::size_t index, const Entry& entry,
                                       const Fleet& fleet) {
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

/// When it is overdue; nothing: never, or not while its robot does another task.
std::optional<MonotonicTime> Overdue::late_at(const WatchedRun& run, std::size_t index, const Entry& entry,
                                              const Fleet& fleet) {
  const auto most = limit(run, index, entry, fleet);
  if (!most || entry.robot_works) return std::nullopt;
  return std::max(entry.since, entry.free_since) + *most;
}

/// When the decider skips it, should its robot be gone then; nothing: it never does.
std::optional<MonotonicTime> Overdue::skipped_at(const WatchedRun& run, std::size_t index, const Entry& entry) {
  const Task& task = run.start->scenario.tasks[index];
  if (entry.phase != Phase::due || entry.ruled || !(task.start_within_s > 0) || !does_without(task))
    return std::nullopt;
  return entry.since + seconds(std::min(task.start_within_s, kLongest_s)) + kRule;
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
    const auto at = late_at(run, index, entry, fleet);
    const bool is_late = at && (entry.told || run.view_as_of >= *at);
    if (is_late) out.push_back({index, text_of(run, index, entry, *limit(run, index, entry, fleet))});
  }
  return out;
}

std::vector<std::size_t> Overdue::to_skip(const WatchedRun& run) const {
  std::vector<std::size_t> out;
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end() || is_held(run)) return out;
  for (const auto& [index, entry] : entries->second) {
    const auto at = skipped_at(run, index, entry);
    if (at && run.view_as_of >= *at) out.push_back(index);
  }
  return out;
}

bool Overdue::wants_view(const WatchedRun& run, const Fleet& fleet, Now now) const {
  const auto entries = runs_.find(run.summary.run);
  if (entries == runs_.end() || is_held(run)) return false;
  return std::ranges::any_of(entries->second, [&](const auto& one) {
    const auto is_old = [&](std::optional<MonotonicTime> at) { return at && now.mono >= *at && run.view_as_of < *at; };
    return is_old(late_at(run, one.first, one.second, fleet)) || is_old(skipped_at(run, one.first, one.second));
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
    for (const auto& at : {late_at(run, index, entry, fleet), skipped_at(run, index, entry)}) {
      if (at && *at > now.mono) out = earlier(out, *at);
    }
    // Nothing of this run says that its robot is free again.
    if (entry.robot_works) out = earlier(out, now.mono + kLook);
  }
  return out;
}

}  // namespace trb::resilience
