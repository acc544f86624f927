#include "services/scheduler/core/waits.hpp"

#include "proto/value.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr const char* kOtherKeys =
    "a person: this node has got new keys since, and does no more of the run; abort it on another node";

/// The first task that waits for a robot to be chosen.
std::optional<TaskIndex> first_unbound(const Run& run) {
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    if (run.facts().wants_robot(static_cast<TaskIndex>(i))) return static_cast<TaskIndex>(i);
  }
  return std::nullopt;
}

std::string problem_text(const Run& run, TaskIndex task) {
  const TaskResult& result = run.results().of(task)->result;
  const std::string where = "task '" + result.key.task + "' ";
  const std::string why = result.reason.empty() ? std::string("no reason given") : result.reason;
  if (result.outcome == TaskOutcome::interrupted) {
    return "a person has to decide: " + where + "was interrupted on '" + result.robot + "': " + why;
  }
  if (result.outcome == TaskOutcome::released) {
    return "a decision: " + where + "was given back by '" + result.robot + "'";
  }
  return where + (result.outcome == TaskOutcome::failed ? "failed" : "is retriable") + " on '" + result.robot +
         "': " + why;
}

/// What does not wait for that decision, in the order of the file.
std::string going_on(const Run& run, const Executor& executor) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const bool here = executor.runs(run.id()) && executor.attempt()->execute.key.task == run.tasks()[task].id;
    const bool goes_on = run.work().timers().is_due(task) || run.work().timers().waits(task);
    if (here || goes_on || run.reports().is_under_way(task)) {
      names.push_back("'" + run.tasks()[task].id + "' on '" + run.epochs().robot_of(task) + "'");
    }
  }
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < kNamed; ++i)
    out += (i == 0 ? "; meanwhile goes on: " : ", ") + names[i];
  return out + (names.size() > kNamed ? " and " + std::to_string(names.size() - kNamed) + " more" : "");
}

std::string problems_text(const Run& run, const Executor& executor) {
  const std::vector<TaskIndex> problems = run.facts().problems();
  const std::string others = problems.size() > 1 ? " (and " + std::to_string(problems.size() - 1) + " more)" : "";
  return problem_text(run, problems.front()) + others + going_on(run, executor);
}

std::string held_text(const Run& run) {
  const PauseOrder& order = *run.orders().pause();
  return "a person: held by '" + order.by + "'" + (order.reason.empty() ? "" : ": " + order.reason) +
         "; trb scenario resume lets it go on";
}

std::string unbound_text(const Run& run) {
  const auto task = first_unbound(run);
  if (!task) return {};
  return "a robot for task '" + run.tasks()[*task].id + "', to be chosen by '" + run.definition().rule().decider() +
         "'; see: trb alert list";
}

std::string abort_text(const Run& run, const Executor& executor) {
  std::string out;
  if (executor.runs(run.id())) out = "task '" + executor.attempt()->execute.key.task + "' to stop here";
  const auto members = run.deliveries().pending().creditors(DeliveryKind::abort);
  if (members.empty()) return out;
  out += (out.empty() ? "" : "; ") + std::string("the confirmation of");
  for (std::size_t i = 0; i < members.size(); ++i) out += (i == 0 ? " '" : ", '") + members[i] + "'";
  return out;
}

std::string robot_text(const Run& run, const Executor& executor) {
  if (run.work().withheld().are_all() && !run.open_tasks().own_are_final()) return kOtherKeys;
  if (executor.attempt()) {
    const Attempt& attempt = *executor.attempt();
    if (!executor.runs(run.id()) || attempt.phase != Phase::refused) return {};
    return "task '" + attempt.execute.key.task + "': " + executor.obstacle();
  }
  for (const TaskIndex task : run.open_tasks().startable()) {
    const std::string obstacle = executor.obstacle(run.tasks()[task].skill);
    if (!obstacle.empty()) return "task '" + run.tasks()[task].id + "': " + obstacle;
  }
  return {};
}

std::string end_text(const std::string& task, const std::string& run, const std::string& robot) {
  return "task '" + task + "' of run " + run + " to end on '" + robot + "'";
}

/// A time of day, not how long it takes: the words stay the same until then.
std::string pause_text(const Run& run, TaskIndex task) {
  const auto at = run.facts().tried_again_at(task);
  return "'" + run.epochs().robot_of(task) + "' to try task '" + run.tasks()[task].id + "' again" +
         (at ? ", at " + to_iso8601(*at) : "");
}

/// Who passes the task on to its robot, as far as one can say: of several tasks before it, any may be the last.
const std::string& giver_of(const Run& run, TaskIndex task) {
  const auto& after = run.tasks()[task].after;
  if (after.empty()) return run.definition().start().submitter;
  return run.definition().is_conditional(task) ? run.epochs().chooser_of(task) : run.epochs().robot_of(after.back());
}

/// What another node's robot does, as it has reported; empty: nothing that this node knows of.
std::string other_task_text(const RunStore& runs, const std::string& robot) {
  for (const Run* run : runs.runs()) {
    if (!run->orders().is_open()) continue;
    for (const TaskIndex task : run->reports().running()) {
      if (run->epochs().robot_of(task) == robot) return end_text(run->tasks()[task].id, run->id(), robot);
    }
  }
  return {};
}

/// What a condition waits for: as this node knows, or as the node that evaluates it has reported.
std::string condition_obstacle(const Run& run) {
  for (const Inquiry& inquiry : run.work().inquiries()) {
    if (!inquiry.obstacle().empty()) return inquiry.obstacle();
  }
  return run.reports().first_wait();
}

/// A task that could begin. If nothing is known of it, who has to pass it on may be gone as well as who has to do it.
std::string handover_text(const Run& run, const RunStore& runs, const Executor& executor, MonotonicTime now) {
  constexpr Duration kUsual = std::chrono::seconds(10);
  for (const auto& [task, since] : run.work().timers().due_since()) {
    const bool is_kept = !run.reports().obstacle_of(task, run.epochs().robot_of(task)).empty();
    if (is_kept || now >= since + kUsual) return due_text(run, runs, executor, task);
  }
  if (const auto task = run.work().timers().first_that_waits()) return due_text(run, runs, executor, *task);
  for (const TaskIndex task : run.open_tasks().choosing_elsewhere()) {
    return "'" + run.epochs().chooser_of(task) + "' to evaluate the condition of task '" + run.tasks()[task].id + "'";
  }
  for (const auto& [node, why] : run.deliveries().refusals()) return "'" + node + "' to take the run: " + why;
  return {};
}

}  // namespace

bool lacks_robot(const Run& run, Clock clock) {
  constexpr Duration kChoosing = std::chrono::seconds(10);
  const auto task = first_unbound(run);
  if (!task) return false;
  if (!run.epochs().decides_here()) return clock.steady >= UtcTime{run.results().of(*task)->result.ended} + kChoosing;
  const auto& since = run.work().timers().unbound_since();
  const auto at = since.find(*task);
  return at != since.end() && clock.mono >= at->second + kChoosing;
}

std::string due_text(const Run& run, const RunStore& runs, const Executor& executor, TaskIndex task) {
  const std::string& robot = run.epochs().robot_of(task);
  if (run.work().timers().waits(task)) return pause_text(run, task);
  if (run.epochs().is_own(task)) {
    if (run.work().withheld().are_all()) return kOtherKeys;
    const bool here = executor.runs(run.id()) && executor.attempt()->execute.key.task == run.tasks()[task].id;
    if (here || !executor.attempt()) return executor.obstacle(run.tasks()[task].skill);
    return end_text(executor.attempt()->execute.key.task, executor.attempt()->execute.key.run, robot);
  }
  const std::string kept = run.reports().obstacle_of(task, robot);
  const auto& refusals = run.deliveries().refusals();
  const auto refusal = refusals.find(robot);
  if (run.deliveries().pending().owes_baton(task) && (kept.empty() || refusal != refusals.end())) {
    return "'" + robot + "' to take its baton" + (refusal == refusals.end() ? "" : ": " + refusal->second);
  }
  if (const std::string other = other_task_text(runs, robot); !other.empty()) return other;
  const std::string begins = "'" + robot + "' to begin task '" + run.tasks()[task].id + "'";
  if (!kept.empty()) return begins + ": " + kept;
  return begins + ", passed on by '" + giver_of(run, task) + "'";
}

std::string recovery_text(const Run& run) {
  return recovery_text(run.silent_members(), run.recovery().is_first_passed() && !run.has_signed());
}

std::string waits_for(const Run& run, const RunStore& runs, const Executor& executor, Clock clock) {
  std::string out;
  const RunState state = state_of(run, executor, clock);
  const bool goes_on = state == RunState::running || state == RunState::paused;
  if (goes_on && run.is_recovering()) return cut_utf8(recovery_text(run), 1024);
  switch (state) {
    case RunState::aborting:
      out = abort_text(run, executor);
      break;
    case RunState::paused:
      out = run.orders().is_held()            ? held_text(run)
            : !run.facts().problems().empty() ? problems_text(run, executor)
            : run.orders().has_new_double()
                ? "'" + run.definition().rule().judge() + "' to hold it: a task was done twice"
                : unbound_text(run);
      break;
    case RunState::running:
      out = robot_text(run, executor);
      if (out.empty()) out = condition_obstacle(run);
      if (out.empty()) out = unbound_text(run);
      if (out.empty()) out = handover_text(run, runs, executor, clock.mono);
      break;
    case RunState::finished:
    case RunState::aborted:
    case RunState::expired:
      break;
  }
  return cut_utf8(out, 1024);
}

}  // namespace trb::scheduler
