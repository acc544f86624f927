#include "services/resilience/core/detection.hpp"

#include <algorithm>

#include "common/base/words.hpp"
#include "common/ranking/pairwise.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/alert_text.hpp"
#include "services/resilience/core/run_end.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kSendAgain = std::chrono::seconds(1);  ///< a problem for which there was no room

std::vector<std::string> ids_of(const WatchedRun& run, const std::vector<std::size_t>& tasks) {
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

/// Updates the alert. A cause that explains more, or has got worse, replaces the old one. A past cause still explains
/// the failed task, but not what else the robot cannot do now.
void follow(Alert& alert, const WatchedRun& run, const RunProblem& problem, bool is_over) {
  if (alert.cause == kOverdue) alert.text = text_reworded(alert.text, problem.text);
  alert.tasks = ids_of(run, problem.tasks);
  alert.needs_word = problem.needs_confirmation;
  const int stronger = strength_of(problem.cause) - strength_of(alert.cause);
  const bool is_worse = stronger == 0 && problem.severity > alert.severity;
  const bool is_next = is_over && strength_of(problem.cause) >= strength_of(kRobotFault);
  // Its node was lost, and is now one with new keys.
  const bool has_come_back = stronger == 0 && problem.text == kNewKeys && !alert.text.starts_with(kNewKeys);
  if (stronger <= 0 && !is_worse && !is_next && !has_come_back) {
    if (is_over) alert.text = text_past(alert.text);
    return;
  }
  const bool is_same = problem.cause == alert.cause;
  alert.text = text_reworded(is_same ? alert.text : std::string(), problem.text);
  alert.cause = problem.cause;
  alert.capability = problem.capability;
  alert.severity = problem.severity;
}

/// Adds one problem per robot.
void add_late(std::vector<RunProblem>& out, const WatchedRun& run, Overdue::Late late, const Fleet& fleet) {
  const std::string& robot = run.view->tasks[late.task].robot;
  auto at = std::ranges::find(out, robot, &RunProblem::robot);
  if (at == out.end()) {
    RunProblem fresh;
    fresh.robot = robot;
    fresh.severity = Severity::urgent;
    fresh.cause = kOverdue;
    fresh.text = std::move(late.text);
    at = out.insert(out.end(), std::move(fresh));
  }
  at->tasks.push_back(late.task);
  at->needs_confirmation = at->needs_confirmation || !why_confirmation(run, late.task, fleet, false).empty();
}

}  // namespace

void Detection::look(Now now, Outbox& out) {
  for (const std::string& id : situation_.take_due_runs(now)) {
    const WatchedRun* run = situation_.runs().find(id);
    if (run == nullptr) overdue_.forget(id);
    if (run == nullptr && situation_.runs().ended(id)) alerts_.note_over(id);
    if (run != nullptr && run->is_known()) look_at(*run, now, out);
  }
  for (const std::string& id : situation_.runs().take_timed()) {
    const WatchedRun* run = situation_.runs().find(id);
    if (run != nullptr && run->is_known()) follow_end(*run, now);
  }
}

/// The scheduler reports every few seconds when a run ends. The run is only looked at when that is near, or when a
/// corrected clock has moved the end near or away.
void Detection::follow_end(const WatchedRun& run, Now now) {
  const std::string& id = run.summary.run;
  const bool warned = std::ranges::any_of(
      alerts_.open(), [&](const Alert* alert) { return alert->run == id && alert->cause == kRunEnds; });
  if (problem_of_end(run, now).has_value() != warned) return situation_.due_runs().notify(id);
  situation_.due_runs().hasten(id, next_moment(run, now));
}

/// When to look at the run even if nothing is reported about it.
std::optional<MonotonicTime> Detection::next_moment(const WatchedRun& run, Now now) const {
  std::optional<MonotonicTime> out = overdue_.next(run, situation_.fleet(), now);
  if (const auto end = end_warning_at(run); end && *end > now.mono) out = earlier(out, end);
  for (const TaskView& task : run.view->tasks) {
    if (!task.robot.empty()) out = earlier(out, situation_.liveness().next(task.robot, now));
  }
  return out;
}

/// Tasks of verdicts on single tasks: that they are given back is no failure.
std::set<std::string> Detection::ruled_tasks(const WatchedRun& run) {
  std::set<std::string> out;
  for (const Alert* alert : alerts_.open()) {
    const bool single = alert->cause == kAsked || alert->cause == kOverdue;
    if (alert->run != run.summary.run || alert->state != AlertState::releasing || !single) continue;
    out.insert(alert->tasks.begin(), alert->tasks.end());
  }
  return out;
}

std::vector<RunProblem> Detection::problems(const WatchedRun& run, Now now) {
  std::vector<RunProblem> out = problems_of(run, situation_.fleet(), situation_.liveness(), ruled_tasks(run), now);
  for (RunProblem& twice : double_executions(run)) out.push_back(std::move(twice));
  if (auto end = problem_of_end(run, now)) out.push_back(std::move(*end));
  return out;
}

void Detection::look_at(const WatchedRun& run, Now now, Outbox& out) {
  if (run.recovers()) {
    (void)overdue_problems(run, now);  // what is not due meanwhile begins anew
    return;
  }
  std::vector<RunProblem> found = problems(run, now);
  bool all_raised = true;
  for (const RunProblem& problem : found) all_raised = meet(run, problem, now, out) && all_raised;
  for (RunProblem& late : overdue_problems(run, now)) {
    all_raised = meet(run, late, now, out) && all_raised;
    found.push_back(std::move(late));
  }
  close_over(run, found, out);
  skip_unbegun(run, now, out);
  if (overdue_.wants_view(run, situation_.fleet(), now)) situation_.runs().refresh(run.summary.run);
  const std::optional<MonotonicTime> at = next_moment(run, now);
  situation_.due_runs().schedule(run.summary.run, all_raised ? at : earlier(at, now.mono + kSendAgain));
}

void Detection::close_over(const WatchedRun& run, const std::vector<RunProblem>& found, Outbox& out) {
  for (Alert* alert : alerts_.open()) {
    if (alert->run != run.summary.run || alert->state == AlertState::releasing) continue;
    const auto is_its = [&](const RunProblem& problem) { return is_about(*alert, run, problem); };
    if (std::ranges::none_of(found, is_its)) alerts_.close(*alert, over_text(*alert), out);
  }
}

/// The last alert of this problem; nullptr: none.
Alert* Detection::find_alert(const WatchedRun& run, const RunProblem& problem) {
  Alert* out = nullptr;
  for (Alert* one : alerts_.open()) {
    if (is_about(*one, run, problem)) out = one;
  }
  return out;
}

/// Raises the alert of that robot in that run, or updates the existing one. False: there is no room for another alert.
bool Detection::meet(const WatchedRun& run, const RunProblem& problem, Now now, Outbox& out) {
  Alert* alert = find_alert(run, problem);
  // A verdict was given: new problems become an alert of their own once it is carried out.
  if (alert != nullptr && alert->state == AlertState::releasing) return true;
  if (alert == nullptr) alert = alerts_.raise(alert_of(run, problem.robot, now), now, out);
  if (alert == nullptr) return false;
  const Alert before = *alert;
  follow(*alert, run, problem, is_past(alert->text) || is_over(*alert, problem, now));
  if (*alert == before) return true;
  if (alert->tasks != before.tasks || before.cause.empty()) on_grown(*alert, run, before.tasks.empty(), now, out);
  out.record(*alert);
  return true;
}

/// Its cause explains more than what is wrong now, and stands no more.
bool Detection::is_over(const Alert& alert, const RunProblem& problem, Now now) const {
  const RobotRecord* robot = situation_.fleet().find(alert.robot);
  if (robot == nullptr || strength_of(problem.cause) >= strength_of(alert.cause)) return false;
  if (alert.cause == kRobotFault) return worst_fault(*robot, alert.capability) == nullptr;
  const bool is_loss = alert.cause == kNodeLost || alert.cause == kRobotLost;
  const bool is_back = robot->reached && robot->profile.is.robot == "ONLINE";
  return is_loss && is_back && situation_.liveness().find(alert.robot, now) == nullptr;
}

void Detection::on_grown(Alert& alert, const WatchedRun& run, bool is_new, Now now, Outbox& out) {
  if (alert.state == AlertState::expired) alert.state = AlertState::open;
  alerts_.work(alert.id).grown_at = now.mono;
  if (may_be_ruled(alert)) proposer_.propose(alert, run, now);
  if (may_be_ruled(alert)) proposer_.request_values(alert, now, out);
  out.log(wants_robot(alert) ? LogLevel::info : LogLevel::warning, is_new ? "alert_raised" : "alert_grown",
          alert.id + ": " + alert.robot + (alert.robot.empty() ? "" : ": ") + alert.cause + ": " + alert.text +
              " (run " + alert.run.substr(0, 8) + ", tasks " + joined(alert.tasks) + ")");
}

/// Problems that no other alert covers, one per robot.
std::vector<RunProblem> Detection::overdue_problems(const WatchedRun& run, Now now) {
  std::set<std::string> covered_otherwise;
  std::set<std::string> covered;
  for (const Alert* alert : alerts_.open()) {
    if (alert->run != run.summary.run) continue;
    auto& tasks = alert->cause == kOverdue && alert->state != AlertState::releasing ? covered : covered_otherwise;
    tasks.insert(alert->tasks.begin(), alert->tasks.end());
  }
  overdue_.follow(run, covered, situation_.runs().runs(), situation_.fleet(), now);
  std::vector<RunProblem> out;
  for (Overdue::Late& late : overdue_.late(run, situation_.fleet())) {
    if (covered_otherwise.contains(run.view->tasks[late.task].id)) continue;
    add_late(out, run, std::move(late), situation_.fleet());
  }
  return out;
}

/// The robot is gone and cannot report that it did not begin in time: the scenario defines what follows.
void Detection::skip_unbegun(const WatchedRun& run, Now now, Outbox& out) {
  if (run.decider() != situation_.node()) return;
  for (const std::size_t index : overdue_.to_skip(run)) {
    const TaskView& task = run.view->tasks[index];
    const Liveness::Gone* gone = situation_.liveness().find(task.robot, now);
    if (gone == nullptr) continue;
    // Its report that it has begun may have come shortly before it was gone.
    if (run.view_as_of < gone->since + Liveness::kGrace) {
      situation_.runs().refresh(run.summary.run);
      continue;
    }
    overdue_.ruled(run, index);
    AlertDecide verdict;
    verdict.verdict = Verdict::skip;
    verdict.stands = true;
    verdict.reason = "did not begin within " + short_number(run.start->scenario.tasks[index].start_within_s) + " s";
    Alert alert = alert_of(run, task.robot, now);
    alert.cause = kOverdue;
    alert.severity = Severity::urgent;
    alert.text = "task '" + task.id + "' " + verdict.reason;
    alert.tasks = {task.id};
    if (const auto ruled = verdicts_.decide_anew(std::move(alert), verdict, now, out); !ruled) {
      out.log(LogLevel::warning, "not_skipped", "task '" + task.id + "': " + ruled.error().what);
    }
  }
}

}  // namespace trb::resilience
