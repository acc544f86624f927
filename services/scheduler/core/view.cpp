#include "services/scheduler/core/view.hpp"

#include <algorithm>

#include "common/scenario/condition.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kShownData = 1024;

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

/// What does not wait for that word, in the order of the file.
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

/// The first task that waits for a robot to be chosen.
std::optional<TaskIndex> first_unbound(const Run& run) {
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    if (run.facts().wants_robot(static_cast<TaskIndex>(i))) return static_cast<TaskIndex>(i);
  }
  return std::nullopt;
}

/// Choosing takes a moment; what takes longer waits for a robot to come.
bool lacks_robot(const Run& run, UtcTime steady) {
  constexpr Duration kChoosing = std::chrono::seconds(10);
  const auto task = first_unbound(run);
  return task && steady >= UtcTime{run.results().of(*task)->result.ended} + kChoosing;
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

/// What a condition waits for, that is evaluated here or by whoever has told.
std::string condition_obstacle(const Run& run) {
  for (const Inquiry& inquiry : run.work().inquiries()) {
    if (!inquiry.obstacle().empty()) return inquiry.obstacle();
  }
  return run.reports().first_wait();
}

/// What a task that is due waits for, as far as this node knows.
std::string due_text(const Run& run, const Executor& executor, TaskIndex task) {
  const std::string& robot = run.epochs().robot_of(task);
  if (run.epochs().is_own(task)) {
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

/// A task that could begin, and of which nothing is heard: who has to pass it on may be gone as well as who has to do
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

double left_s(const Run& run, Clock clock) {
  return std::max(0.0, to_seconds(Duration{run.definition().start().expires - clock.steady.ns}));
}

std::string condition_of(const Run& run, TaskIndex task) {
  if (!run.definition().is_conditional(task)) return {};
  const Condition& condition = run.tasks()[task].when.front();
  const HeldChoice* held = run.facts().choice_on(task);
  if (held == nullptr) return condition_text(condition);
  return verdict_text(condition, held->choice.node, held->choice.reading);
}

TaskState state_by_outcome(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::finished:
      return TaskState::finished;
    case TaskOutcome::skipped:
      return TaskState::skipped;
    case TaskOutcome::failed:
      return TaskState::failed;
    case TaskOutcome::retriable:
    case TaskOutcome::interrupted:
      return TaskState::retriable;
    case TaskOutcome::none:
    case TaskOutcome::released:
      break;
  }
  return TaskState::waiting;
}

/// What a baton has said of a task.
struct Known {
  bool is_final = false;
  bool skipped = false;
};

/// The state of a task whose result is not held.
TaskState open_state(const Run& run, const Executor& executor, TaskIndex task, Known known) {
  if (executor.runs(run.id()) && executor.attempt()->execute.key.task == run.tasks()[task].id) {
    return executor.attempt()->phase == Phase::running ? TaskState::running : TaskState::initializing;
  }
  if (known.is_final) return known.skipped ? TaskState::skipped : TaskState::finished;
  return run.reports().progress_of(task).value_or(TaskState::waiting);
}

TaskView task_view(const Run& run, const Executor& executor, TaskIndex task, Known known) {
  const Task& is = run.tasks()[task];
  TaskView view;
  view.id = is.id;
  if (!run.epochs().is_unbound(task)) view.robot = run.epochs().robot_of(task);
  view.skill = is.skill;
  view.failed_by = run.results().failed_by(task);
  view.twice = std::ranges::find(run.orders().doubles(), is.id) != run.orders().doubles().end();
  view.due = run.work().timers().is_due(task);
  if (view.due) view.waits_for = cut_utf8(due_text(run, executor, task), kDefaultMaxSize);
  view.after = is.after;
  view.condition = condition_of(run, task);
  // A task comes from no robot if the decider's node has held it.
  if (run.epochs().is_ruled(task) && run.epochs().robot_before(task) != run.definition().rule().decider())
    view.moved_from = run.epochs().robot_before(task);
  const HeldResult* held = run.facts().current(task);
  if (held == nullptr) {
    view.state = open_state(run, executor, task, known);
    view.attempt = run.results().of(task) == nullptr ? 0 : run.facts().next_attempt(task);
    return view;
  }
  const TaskResult& result = held->result;
  view.state = state_by_outcome(result.outcome);
  view.outcome = result.outcome;
  view.reason = result.reason;
  view.attempt = result.key.attempt;
  view.started = result.started;
  view.ended = result.ended;
  view.duration_s = result.duration_s;
  view.data = cut_utf8(result.data, kShownData);
  return view;
}

}  // namespace

RunState state_of(const Run& run, const Executor& executor, Clock clock) {
  if (run.orders().is_aborted()) {
    const bool open = executor.runs(run.id()) || !run.deliveries().pending().creditors(DeliveryKind::abort).empty();
    return open ? RunState::aborting : RunState::aborted;
  }
  const bool doubles = run.orders().is_held_for_doubles() || run.orders().has_new_double();
  if (run.orders().has_ended() || (run.facts().all_final() && !doubles)) return RunState::finished;
  if (run.expired(clock.steady)) return RunState::expired;
  const bool waits =
      run.orders().is_held() || doubles || !run.facts().problems().empty() || lacks_robot(run, clock.steady);
  return waits ? RunState::paused : RunState::running;
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

void fit(RunView& view) {
  constexpr std::size_t kMost = kMaxDataSize - 1024;
  for (const std::size_t kept : {128U, 0U}) {
    if (encode(view).size() <= kMost) return;
    for (TaskView& task : view.tasks) {
      task.data = cut_utf8(task.data, kept);
      task.waits_for = cut_utf8(task.waits_for, kept);
      task.reason = cut_utf8(task.reason, kept);
      task.condition = cut_utf8(task.condition, kept);
      if (kept == 0) task.failed_by.clear();
    }
  }
  const std::size_t decisions = view.decisions.size();
  for (const std::size_t oldest : {decisions / 2, decisions}) {
    if (encode(view).size() <= kMost) return;
    for (std::size_t i = 0; i < oldest; ++i) view.decisions[i].tasks.clear();
  }
}

RunView view_of(const Run& run, const Executor& executor, Clock clock) {
  RunView view;
  view.run = run.id();
  view.name = run.definition().start().scenario.name;
  view.state = state_of(run, executor, clock);
  view.waits_for = waits_for(run, executor, clock);
  view.priority = run.definition().start().priority;
  view.left_s = left_s(run, clock);
  view.epoch = run.epochs().current();
  view.submitter = run.definition().start().submitter;
  view.created = run.definition().start().created;
  view.expires = run.definition().start().expires;
  for (std::size_t i = 0; i < run.epochs().decisions().size(); ++i) {
    const Decision& by = run.epochs().decisions()[i];
    view.decisions.push_back({by.epoch, by.by, by.alert, by.person, by.reason, by.time, by.tasks});
  }
  if (run.orders().pause() != nullptr) view.pause_number = run.orders().pause()->number;
  if (run.orders().is_held()) view.paused_by = run.orders().pause()->by;
  const std::vector<bool> known = run.known_final();
  const std::vector<bool> skipped = run.known_skipped();
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    view.tasks.push_back(task_view(run, executor, static_cast<TaskIndex>(i), {known[i], skipped[i]}));
  }
  fit(view);
  return view;
}

RunSummary summary_of(const Run& run, const Executor& executor, Clock clock) {
  RunSummary summary;
  summary.run = run.id();
  summary.name = run.definition().start().scenario.name;
  summary.state = state_of(run, executor, clock);
  summary.waits_for = waits_for(run, executor, clock);
  summary.priority = run.definition().start().priority;
  summary.left_s = left_s(run, clock);
  summary.created = run.definition().start().created;
  summary.tasks = static_cast<std::uint32_t>(run.tasks().size());
  const std::vector<bool> known = run.known_final();
  summary.epoch = run.epochs().current();
  summary.version = run.version();
  summary.tasks_final = static_cast<std::uint32_t>(std::count(known.begin(), known.end(), true));
  return summary;
}

RunSummary summary_of(const RunView& view) {
  RunSummary summary;
  summary.run = view.run;
  summary.name = view.name;
  summary.state = view.state;
  summary.waits_for = view.waits_for;
  summary.created = view.created;
  summary.tasks = static_cast<std::uint32_t>(view.tasks.size());
  summary.tasks_final =
      static_cast<std::uint32_t>(std::count_if(view.tasks.begin(), view.tasks.end(), [](const auto& task) {
        return task.state == TaskState::finished || task.state == TaskState::skipped;
      }));
  summary.epoch = view.epoch;
  summary.priority = view.priority;
  summary.left_s = view.left_s;
  summary.over = view.over;
  return summary;
}

}  // namespace trb::scheduler
