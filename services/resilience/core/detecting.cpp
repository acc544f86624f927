// ResilienceCore: what a run's robots cannot do any more becomes an alert.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/core/run_end.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxText = 1024;
constexpr Duration kLook = std::chrono::seconds(1);  ///< so long after it found no room a trouble is told again

std::vector<std::string> names_of(const WatchedRun& run, const std::vector<std::size_t>& tasks) {
  std::vector<std::string> out;
  for (const std::size_t index : tasks) out.push_back(run.view->tasks[index].id);
  return out;
}

std::string over_text(const Alert& alert) {
  if (alert.cause == kOverdue) return "its tasks go on";
  if (alert.cause == kTwice) return "the run is held no more";
  if (alert.cause == kRunEnds) return "the run does not end soon";
  return "its cause is over: nothing failed, nothing was moved";
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

}  // namespace

void ResilienceCore::look_at_runs(Now now, Outbox& out) {
  for (const std::string& run : watcher_.take_changed()) {
    count_tasks(run);
    due_runs_.notify(run);
  }
  const std::set<std::string> runs = due_runs_.take(now.mono);
  if (!runs.empty()) stirred_ = true;
  for (const std::string& id : runs) {
    const WatchedRun* run = watcher_.find(id);
    if (run == nullptr) overdue_.forget(id);
    if (run != nullptr && run->is_known()) look_at_run(*run, now, out);
  }
  // The scheduler tells every few seconds when a run ends; it is looked at only when that is near.
  for (const std::string& id : watcher_.take_timed()) {
    const WatchedRun* run = watcher_.find(id);
    if (run != nullptr && run->is_known()) due_runs_.hasten(id, next_moment(*run, now));
  }
}

/// When the run is to be looked at, though nothing is told of it.
std::optional<MonotonicTime> ResilienceCore::next_moment(const WatchedRun& run, Now now) const {
  std::optional<MonotonicTime> out = overdue_.next(run, fleet_, now);
  if (const auto end = end_told_at(run); end && *end > now.mono) out = earlier(out, end);
  for (const TaskView& task : run.view->tasks) {
    if (!task.robot.empty()) out = earlier(out, presence_.next(task.robot, now));
  }
  return out;
}

void ResilienceCore::count_tasks(const std::string& run) {
  for (const std::string& robot : open_tasks_.count(run, watcher_.find(run))) {
    fleet_.set_later_tasks(robot, open_tasks_.of(robot));
  }
}

void ResilienceCore::look_at_run(const WatchedRun& run, Now now, Outbox& out) {
  std::set<std::string> robots;
  for (const TaskView& task : run.view->tasks) {
    if (!task.robot.empty() && robots.insert(task.robot).second) {
      presence_.look(task.robot, fleet_.find(task.robot), now);
    }
  }
  // A verdict on single tasks: that they are given back for it is no failure.
  std::set<std::string> ruled;
  for (const Alert* alert : book_.open()) {
    const bool single = alert->cause == kAsked || alert->cause == kOverdue;
    if (alert->run != run.summary.run || alert->state != AlertState::releasing || !single) continue;
    ruled.insert(alert->tasks.begin(), alert->tasks.end());
  }
  std::vector<Trouble> troubles = troubles_of(run, fleet_, presence_, ruled, now);
  for (Trouble& twice : double_executions(run)) troubles.push_back(std::move(twice));
  if (auto end = trouble_of_end(run, now)) troubles.push_back(std::move(*end));
  bool all_told = true;
  for (const Trouble& trouble : troubles) all_told = meet(run, trouble, now, out) && all_told;
  for (Trouble& late : overdue_troubles(run, now)) {
    all_told = meet(run, late, now, out) && all_told;
    troubles.push_back(std::move(late));
  }
  for (Alert* alert : book_.open()) {
    if (alert->run != run.summary.run || alert->state == AlertState::releasing) continue;
    const auto is_its = [&](const Trouble& trouble) { return is_about(*alert, run, trouble); };
    if (std::ranges::none_of(troubles, is_its)) {
      close(*alert, over_text(*alert), out);
    }
  }
  skip_unbegun(run, now, out);
  const std::optional<MonotonicTime> at = next_moment(run, now);
  due_runs_.schedule(run.summary.run, all_told ? at : earlier(at, now.mono + kLook));
}

/// Raises the alert of that robot in that run, or lets the one that is there follow what is known. False: there is no
/// room for another alert.
bool ResilienceCore::meet(const WatchedRun& run, const Trouble& trouble, Now now, Outbox& out) {
  Alert* alert = nullptr;
  for (Alert* one : book_.open()) {
    if (is_about(*one, run, trouble)) alert = one;
  }
  // A verdict was given: what is new becomes an alert of its own once that is done.
  if (alert != nullptr && alert->state == AlertState::releasing) return true;
  if (alert == nullptr) {
    alert = raise(alert_of(run, trouble.robot, now), now, out);
    if (alert == nullptr) return false;
  }
  const Alert before = *alert;
  if (alert->cause == kOverdue) alert->text = cut_utf8(trouble.text, kMaxText);
  alert->tasks = names_of(run, trouble.tasks);
  alert->needs_word = trouble.needs_word;
  // What explains more is told; what is over explains the failed task all the same.
  if (strength_of(trouble.cause) > strength_of(alert->cause)) {
    alert->cause = trouble.cause;
    alert->capability = trouble.capability;
    alert->severity = trouble.severity;
    alert->text = cut_utf8(trouble.text, kMaxText);
  }
  if (*alert == before) return true;
  if (alert->tasks != before.tasks || before.cause.empty()) {
    if (alert->state == AlertState::expired) alert->state = AlertState::open;
    works_[alert->id].grown_at = now.mono;
    if (may_be_ruled(*alert)) propose(*alert, run, now);
    if (may_be_ruled(*alert)) ask_values(*alert, now, out);
    out.log(wants_robot(*alert) ? LogLevel::info : LogLevel::warning,
            before.tasks.empty() ? "alert_raised" : "alert_grown",
            alert->id + ": " + alert->robot + (alert->robot.empty() ? "" : ": ") + alert->cause + ": " + alert->text +
                " (run " + alert->run.substr(0, 8) + ", tasks " + joined(alert->tasks) + ")");
  }
  out.record(*alert);
  return true;
}

/// Without what may change: the cause, and what follows from it.
Alert ResilienceCore::alert_of(const WatchedRun& run, const std::string& robot, Now now) {
  Alert out;
  out.run = run.summary.run;
  out.name = run.view->name;
  out.robot = robot;
  out.time = now.utc.ns;
  return out;
}

Alert* ResilienceCore::raise(Alert fresh, Now now, Outbox& out) {
  fresh.policy = "ask";
  fresh.expires = fresh.run.empty() ? 0 : (now.utc + settings_.resilience.expires).ns;
  const std::string robot = fresh.robot;
  Alert* alert = book_.add(std::move(fresh));
  if (alert == nullptr) {
    out.count("dropped.alerts");
    out.log(LogLevel::error, "too_many_alerts",
            "too many alerts are open: none for " + robot + "; decide on some: trb alert list");
  }
  return alert;
}

/// A fault that stands is told, whether or not a run minds it.
void ResilienceCore::tell_standing(Now now, Outbox& out) {
  standing_.follow(fleet_, now);
  for (const Alert* alert : book_.open()) {
    if (alert->cause != "robot_fault") continue;
    const RobotRecord* robot = fleet_.find(alert->robot);
    if (robot == nullptr) continue;
    for (const Fault& fault : robot->faults) {
      if (tells_of(*alert, fault.capability)) standing_.told({alert->robot, fault.capability}, now);
    }
  }
  for (const Standing::Key& key : standing_.untold(now)) {
    if (!book_.has_room_for_lone()) return out.count("dropped.alerts");
    const RobotRecord& robot = *fleet_.find(key.robot);
    if (!key.capability.empty() && worst_fault(robot, "") != nullptr) continue;  // it is told of the whole robot
    if (raise_lone(key, now, out) == nullptr) return;
  }
}

/// The fault stands.
Alert* ResilienceCore::raise_lone(const Standing::Key& key, Now now, Outbox& out) {
  const Fault& fault = *worst_fault(*fleet_.find(key.robot), key.capability);
  Alert fresh;
  fresh.robot = key.robot;
  fresh.capability = key.capability;
  fresh.severity = fault.severity;
  fresh.cause = "robot_fault";
  fresh.text = cut_utf8(fault.text, kMaxText);
  fresh.time = now.utc.ns;
  Alert* alert = raise(std::move(fresh), now, out);
  if (alert == nullptr) return nullptr;
  standing_.told(key, now);
  look_at_lone(*alert, now, out);
  out.record(*alert);
  out.log(LogLevel::warning, "alert_raised", alert->id + ": " + alert->robot + ": " + alert->text + " (no run)");
  return alert;
}

void ResilienceCore::close(Alert& alert, const std::string& why, Outbox& out) {
  alert.state = AlertState::closed;
  if (watcher_.find(alert.run) != nullptr) due_runs_.notify(alert.run);
  alert.waits_for = cut_utf8(why, 512);
  works_.erase(alert.id);
  record_handed(alert, "decision_dropped", out);
  out.record(alert);
  out.log(LogLevel::info, "alert_closed", alert.id + ": " + why);
}

}  // namespace trb::resilience
