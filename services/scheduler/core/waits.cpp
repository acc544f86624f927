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
    if (here || run.reports().is_under_way(task) || run.work().timers().is_due(task)) {
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

/// What a condition waits for: as this node knows, or as the node that evaluates it has reported.
std::string condition_obstacle(const Run& run) {
  for (const Inquiry& inquiry : run.work().inquiries()) {
    if (!inquiry.obstacle().empty()) return inquiry.obstacle();
  }
  return run.reports().first_wait();
}

/// A task that could begin, and of which nothing is known: who has to pass it on may be gone as well as who has to do
/// it.
std::string handover_text(const Run& run, const Executor& executor, MonotonicTime now) {
  constexpr Duration kUsual = std::chrono::seconds(10);
  for (const auto& [task, since] : run.work().timers().due_since()) {
    if (now >= since + kUsual) return due_text(run, executor, task);
  }
  for (const TaskIndex task : run.open_tasks().choosing_elsewhere()) {
    return "'" + run.epochs().chooser_of(task) + "' to evaluate the condition of task '" + run.tasks()[task].id + "'";
  }
  for (const auto& [node, why] : run.deliveries().refusals()) return "'" + node + "' to take the run: " + why;
  return {};
}

}  // namespace

bool lacks_robot(const Run& run, UtcTime steady) {
  constexpr Duration kChoosing = std::chrono::seconds(10);
  const auto task = first_unbound(run);
  return task && steady >= UtcTime{run.results().of(*task)->result.ended} + kChoosing;
}

std::string due_text(const Run& run, const Executor& executor, TaskIndex task) {
  const std::string& robot = run.epochs().robot_of(task);
  if (run.epochs().is_own(task)) {
    if (run.work().withheld().are_all()) return kOtherKeys;
    const bool here = executor.runs(run.id()) && executor.attempt()->execute.key.task == run.tasks()[task].id;
    const std::string obstacle = executor.obstacle(run.tasks()[task].skill);
    if (!obstacle.empty() || here || !executor.attempt()) return obstacle;
    return "task '" + executor.attempt()->execute.key.task + "' of run " + executor.attempt()->execute.key.run +
           " to end on '" + robot + "'";
  }
  if (run.deliveries().pending().owes_baton(task)) {
    const auto& refusals = run.deliveries().refusals();
    const auto refusal = refusals.find(robot);
    return "'" + robot + "' to take its baton" + (refusal == refusals.end() ? "" : ": " + refusal->second);
  }
  const auto& after = run.tasks()[task].after;
  const std::string& giver = after.empty() ? run.definition().start().submitter : run.epochs().robot_of(after.back());
  return "'" + robot + "' to begin task '" + run.tasks()[task].id + "', passed on by '" + giver + "'";
}

std::string waits_for(const Run& run, const Executor& executor, Clock clock) {
  std::string out;
  switch (state_of(run, executor, clock)) {
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
      if (out.empty()) out = handover_text(run, executor, clock.mono);
      break;
    case RunState::finished:
    case RunState::aborted:
    case RunState::expired:
      break;
  }
  return cut_utf8(out, 1024);
}

}  // namespace trb::scheduler
