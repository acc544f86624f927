#include "services/resilience/core/run_problems.hpp"

#include <algorithm>

#include "common/base/words.hpp"
#include "common/security/keys.hpp"

namespace trb::resilience {
namespace {

/// Does the run wait for a decision because of this task? A failure that its robot will retry is no problem yet.
bool waits_for_help(const WatchedRun& run, std::size_t index) {
  const TaskView& task = run.view->tasks[index];
  if (is_final(task) || !run.has_stopped(index)) return false;
  if (task.outcome == TaskOutcome::released) return true;
  if (run.view->state != RunState::paused) return false;
  // A run held by a person is PAUSED whether or not the task has tries left.
  return run.view->paused_by.empty() || task.attempt > run.start->scenario.tasks[index].retries;
}

bool has_not_begun(const TaskView& task) {
  return task.state == TaskState::waiting && task.outcome == TaskOutcome::none;
}

/// Collects the worst problem of a robot, task by task.
class Finder {
 public:
  Finder(const WatchedRun& run, const Fleet& fleet, const std::string& robot, const Liveness::Gone* gone)
      : run_(run),
        fleet_(fleet),
        record_(fleet.find(robot)),
        gone_(gone),
        has_new_keys_(has_new_keys(run, robot, fleet)) {
    out_.robot = robot;
  }

  void look(std::size_t index) {
    const TaskView& task = run_.view->tasks[index];
    if (is_final(task)) return;
    const bool stopped = waits_for_help(run_, index);
    const std::string capability = capability_of(run_, index, fleet_);
    const Fault* fault = record_ == nullptr ? nullptr : fault_of(*record_, capability);
    const OutOfUse* retired = record_ == nullptr ? nullptr : retirement_of(*record_);
    // A running task goes on to its end.
    const bool leaves = retired != nullptr && (stopped || has_not_begun(task));
    if (!stopped && !leaves && fault == nullptr && gone_ == nullptr && !has_new_keys_) return;
    out_.tasks.push_back(index);
    out_.failed = out_.failed || stopped;
    out_.needs_confirmation = out_.needs_confirmation || !why_confirmation(run_, index, fleet_, false).empty();
    if (has_new_keys_) add_cause(kNodeLost, Severity::critical, "", kNewKeys);
    if (gone_ != nullptr) add_cause(gone_->cause, Severity::critical, "", gone_->text);
    if (leaves)
      add_cause(kRobotRetired, Severity::warning, "", run_.view->tasks[index].robot + " " + retired_text(*retired));
    if (fault != nullptr) add_cause(kRobotFault, fault->severity, fault->capability, fault->text);
    if (!stopped) return;
    const bool interrupted = task.outcome == TaskOutcome::interrupted;
    add_cause(interrupted ? kTaskInterrupted : kTaskFailed, interrupted ? Severity::critical : Severity::urgent,
              capability, "task '" + task.id + "': " + (task.reason.empty() ? "stopped" : task.reason));
  }

  RunProblem take() { return std::move(out_); }

 private:
  /// The strongest cause is told, and the worst severity counts: a policy must not move what a FATAL fault has stopped
  /// because the robot is silent, too.
  void add_cause(std::string_view cause, Severity severity, const std::string& capability, const std::string& text) {
    const int mine = strength_of(cause);
    const int known = strength_of(out_.cause);
    const bool is_worse = out_.cause.empty() || severity > out_.severity;
    if (is_worse) out_.severity = severity;
    if (mine < known || (mine == known && !is_worse)) return;
    out_.cause = cause;
    out_.capability = capability;
    out_.text = text;
  }

  const WatchedRun& run_;
  const Fleet& fleet_;
  const RobotRecord* record_;
  const Liveness::Gone* gone_;
  bool has_new_keys_;
  RunProblem out_;
};

RunProblem robot_wanted(const Task& task, std::size_t index) {
  RunProblem out;
  out.cause = kWantsRobot;
  out.text = "task '" + task.id + "' wants a robot with '" + task.skill + "' and " + joined(task.requires_);
  out.tasks = {index};
  return out;
}

}  // namespace

bool wants_robot(const Alert& alert) {
  return alert.cause == kWantsRobot;
}

std::string_view family_of(std::string_view cause) {
  for (const std::string_view own : {kWantsRobot, kOverdue, kTwice, kRunEnds, kAsked}) {
    if (cause == own) return own;
  }
  return "failure";
}

bool may_be_ruled(const Alert& alert) {
  return alert.cause != kTwice && alert.cause != kRunEnds;
}

bool covers(const Alert& alert, std::string_view capability) {
  return alert.cause == kRobotFault && (alert.capability.empty() || alert.capability == capability);
}

bool is_pinned(const Alert& alert, const WatchedRun& run, std::string_view task) {
  const auto index = run.find_task(task);
  return index && run.start->scenario.tasks[*index].pinned && !wants_robot(alert);
}

bool is_about(const Alert& alert, const WatchedRun& run, const RunProblem& problem) {
  if (alert.run != run.summary.run || alert.robot != problem.robot) return false;
  if (family_of(alert.cause) != family_of(problem.cause)) return false;
  return problem.cause != kWantsRobot ||
         alert.tasks == std::vector<std::string>{run.view->tasks[problem.tasks.front()].id};
}

int strength_of(std::string_view cause) {
  if (cause == kNodeLost || cause == kRobotLost) return 5;
  if (cause == kRobotFault) return 4;
  if (cause == kRobotRetired) return 3;
  if (cause == kTaskInterrupted) return 2;
  return cause.empty() ? 0 : 1;
}

std::string capability_of(const WatchedRun& run, std::size_t task, const Fleet& fleet) {
  const RobotRecord* robot = fleet.find(run.view->tasks[task].robot);
  const SkillInfo* skill = robot == nullptr ? nullptr : find_skill(*robot, run.view->tasks[task].skill);
  return skill == nullptr ? std::string() : skill->capability;
}

bool has_new_keys(const WatchedRun& run, std::string_view robot, const Fleet& fleet) {
  const RobotRecord* record = fleet.find(robot);
  const auto member = run.certificates.find(robot);
  return record != nullptr && member != run.certificates.end() && has_newer_keys(record->certificate, member->second);
}

std::string why_confirmation(const WatchedRun& run, std::size_t index, const Fleet& fleet, bool retry) {
  const TaskView& task = run.view->tasks[index];
  if (is_final(task)) return {};
  const RobotRecord* robot = fleet.find(task.robot);
  const bool stopped = run.has_stopped(index);
  if (stopped && task.outcome == TaskOutcome::interrupted) {
    const SkillInfo* skill = robot == nullptr ? nullptr : find_skill(*robot, task.skill);
    if (retry && skill != nullptr && skill->repeatable) return {};
    return "nobody knows what became of task '" + task.id + "'";
  }
  if (stopped) return {};
  if (!retry && has_new_keys(run, task.robot, fleet))
    return task.robot + " has got new keys, and cannot tell what became of task '" + task.id + "'";
  if (retry || (robot != nullptr && robot->reached)) return {};
  return task.robot + " is silent";
}

std::vector<Alert> lesser_faults(const Fleet& fleet, UtcTime since) {
  std::vector<Alert> out;
  for (const auto& [id, robot] : fleet.robots()) {
    for (const Fault& fault : robot.faults) {
      if (fault.severity >= Severity::critical || fault.since < since || fault_of(robot, fault.capability) != nullptr)
        continue;
      Alert& shown = out.emplace_back();
      shown.robot = id;
      shown.capability = fault.capability;
      shown.severity = fault.severity;
      shown.cause = kRobotFault;
      shown.text = fault.text;
      shown.time = fault.since.ns;
      shown.state = AlertState::closed;
    }
  }
  std::ranges::stable_sort(out, std::ranges::greater{}, &Alert::time);
  return out;
}

std::vector<RunProblem> double_executions(const WatchedRun& run) {
  std::vector<RunProblem> out;
  if (run.view->paused_by.empty()) return out;
  for (std::size_t i = 0; i < run.view->tasks.size(); ++i) {
    const TaskView& task = run.view->tasks[i];
    if (!task.twice) continue;
    auto at = std::ranges::find(out, task.robot, &RunProblem::robot);
    if (at == out.end()) {
      RunProblem fresh;
      fresh.robot = task.robot;
      fresh.severity = Severity::critical;
      fresh.cause = kTwice;
      fresh.text = "task '" + task.id + "' was done twice: look at what was done, then trb scenario resume " +
                   run.summary.run.substr(0, 8) + ", or abort the run";
      at = out.insert(out.end(), std::move(fresh));
    }
    at->tasks.push_back(i);
  }
  return out;
}

std::vector<RunProblem> problems_of(const WatchedRun& run, const Fleet& fleet, const Liveness& liveness,
                                    const std::set<std::string>& ruled, Now now) {
  const std::string decider = run.decider();  // it has no robot: its tasks are those that it skips
  std::vector<std::string> order;
  std::map<std::string, Finder, std::less<>> finders;
  std::vector<RunProblem> out;
  for (std::size_t i = 0; i < run.view->tasks.size() && i < run.start->scenario.tasks.size(); ++i) {
    const std::string& robot = run.view->tasks[i].robot;
    if (ruled.contains(run.view->tasks[i].id)) continue;
    if (robot.empty() && run.has_stopped(i)) out.push_back(robot_wanted(run.start->scenario.tasks[i], i));
    if (robot.empty() || robot == decider) continue;
    auto at = finders.find(robot);
    if (at == finders.end()) {
      order.push_back(robot);
      at = finders.emplace(robot, Finder(run, fleet, robot, liveness.find(robot, now))).first;
    }
    at->second.look(i);
  }
  for (const std::string& robot : order) {
    RunProblem problem = finders.at(robot).take();
    if (!problem.tasks.empty()) out.push_back(std::move(problem));
  }
  return out;
}

}  // namespace trb::resilience
