// ResilienceCore: what a run's robots cannot do any more becomes an alert.
#include <algorithm>

#include "proto/value.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/core/run_end.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxText = 1024;

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

void ResilienceCore::look_at_runs(bool all, Now now, Outbox& out) {
  for (const std::string& run : watcher_.take_changed()) {
    count_tasks(run);
    stirred_runs_.insert(run);
  }
  // Who has been away for the grace by now stirs nobody by a word.
  if (all) {
    for (const auto& [id, run] : watcher_.runs()) stirred_runs_.insert(id);
  }
  const std::set<std::string> runs = std::exchange(stirred_runs_, {});
  if (!runs.empty()) stirred_ = true;
  for (const std::string& id : runs) {
    const WatchedRun* run = watcher_.find(id);
    if (run == nullptr) overdue_.forget(id);
    if (run != nullptr && run->is_known()) look_at_run(*run, now, out);
  }
}

/// How many tasks each robot still has, in any run: the less it has, the more it is at hand.
void ResilienceCore::count_tasks(const std::string& id) {
  std::map<std::string, std::uint32_t> tasks;
  if (const WatchedRun* run = watcher_.find(id); run != nullptr && run->view) {
    for (const TaskView& task : run->view->tasks) {
      if (!task.robot.empty() && !is_final(task)) ++tasks[task.robot];
    }
  }
  const std::map<std::string, std::uint32_t> before = std::exchange(open_tasks_[id], tasks);
  if (tasks.empty()) open_tasks_.erase(id);
  for (const auto& [robot, count] : before) tasks.try_emplace(robot, 0);
  for (const auto& [robot, count] : tasks) {
    std::uint32_t sum = 0;
    for (const auto& [run, robots] : open_tasks_) {
      if (const auto at = robots.find(robot); at != robots.end()) sum += at->second;
    }
    fleet_.set_later_tasks(robot, sum);
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
  for (const Trouble& trouble : troubles) meet(run, trouble, now, out);
  for (Trouble& late : overdue_troubles(run, now)) {
    meet(run, late, now, out);
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
}

/// Raises the alert of that robot in that run, or lets the one that is there follow what is known.
void ResilienceCore::meet(const WatchedRun& run, const Trouble& trouble, Now now, Outbox& out) {
  Alert* alert = nullptr;
  for (Alert* one : book_.open()) {
    if (is_about(*one, run, trouble)) alert = one;
  }
  // A verdict was given: what is new becomes an alert of its own once that is done.
  if (alert != nullptr && alert->state == AlertState::releasing) return;
  if (alert == nullptr) {
    alert = raise(alert_of(run, trouble.robot, now), now, out);
    if (alert == nullptr) return;
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
  if (*alert == before) return;
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
  if (watcher_.find(alert.run) != nullptr) stirred_runs_.insert(alert.run);
  alert.waits_for = cut_utf8(why, 512);
  works_.erase(alert.id);
  record_handed(alert, "decision_dropped", out);
  out.record(alert);
  out.log(LogLevel::info, "alert_closed", alert.id + ": " + why);
}

}  // namespace trb::resilience
