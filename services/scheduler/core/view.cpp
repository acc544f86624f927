#include "services/scheduler/core/view.hpp"

#include <algorithm>

#include "common/scenario/condition.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/waits.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kShownData = 1024;

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

/// What a baton has reported on a task.
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

void show(const TaskResult& result, TaskView& view) {
  view.state = state_by_outcome(result.outcome);
  view.outcome = result.outcome;
  view.reason = result.reason;
  view.attempt = result.key.attempt;
  view.started = result.started;
  view.ended = result.ended;
  view.duration_s = result.duration_s;
  view.data = cut_utf8(result.data, kShownData);
}

TaskView task_view(const Run& run, const RunStore& runs, const Executor& executor, TaskIndex task, Known known) {
  const Task& is = run.tasks()[task];
  TaskView view;
  view.id = is.id;
  if (!run.epochs().is_unbound(task)) view.robot = run.epochs().robot_of(task);
  view.skill = is.skill;
  view.failed_by = run.results().failed_by(task);
  view.twice = run.orders().is_double(is.id);
  view.due = run.work().timers().is_due(task);
  const bool pauses = run.orders().goes_on() && run.work().timers().waits(task);
  if (view.due || pauses) view.waits_for = cut_utf8(due_text(run, runs, executor, task), kDefaultMaxSize);
  view.after = is.after;
  view.condition = condition_of(run, task);
  // A task comes from no robot if the decider's node has held it.
  if (run.epochs().is_ruled(task) && run.epochs().robot_before(task) != run.definition().rule().decider())
    view.moved_from = run.epochs().robot_before(task);
  if (const HeldResult* held = run.facts().current(task)) {
    show(held->result, view);
  } else {
    view.state = open_state(run, executor, task, known);
    view.attempt = run.results().of(task) == nullptr ? 0 : run.facts().next_attempt(task);
  }
  return view;
}

/// What a run's view and its summary both say.
template <class Shown>
Shown shown(const Run& run, const RunStore& runs, const Executor& executor, Clock clock) {
  Shown out;
  out.run = run.id();
  out.name = run.definition().start().scenario.name;
  out.state = state_of(run, executor, clock);
  out.waits_for = waits_for(run, runs, executor, clock);
  out.priority = run.definition().start().priority;
  out.left_s = left_s(run, clock);
  out.epoch = run.epochs().current();
  out.created = run.definition().start().created;
  out.recovers = run.is_recovering();
  return out;
}

}  // namespace

RunState state_of(const Run& run, const Executor& executor, Clock clock) {
  if (run.orders().is_aborted()) {
    const bool open = executor.runs(run.id()) || !run.deliveries().pending().creditors(DeliveryKind::abort).empty();
    return open ? RunState::aborting : RunState::aborted;
  }
  const bool doubles = run.orders().is_held_for_doubles() || run.orders().has_new_double();
  if (run.orders().has_ended() || (run.facts().all_final() && !doubles)) return RunState::finished;
  if (run.definition().expired(clock.steady)) return RunState::expired;
  // What is to be decided shows once the members have told all, or a person has to know that one does not.
  if (run.is_recovering() && !run.orders().is_held() && !run.recovery().is_stuck(run.silent_members()))
    return RunState::running;
  const bool waits = run.is_recovering() || run.orders().is_held() || doubles || !run.facts().problems().empty() ||
                     lacks_robot(run, clock);
  return waits ? RunState::paused : RunState::running;
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

RunView view_of(const Run& run, const RunStore& runs, const Executor& executor, Clock clock) {
  auto view = shown<RunView>(run, runs, executor, clock);
  view.submitter = run.definition().start().submitter;
  view.expires = run.definition().start().expires;
  for (std::size_t i = 0; i < run.epochs().decisions().size(); ++i) {
    const Decision& by = run.epochs().decisions()[i];
    view.decisions.push_back({by.epoch, by.by, by.alert, by.person, by.reason, by.time, by.tasks});
  }
  view.pause_number = run.pause_number();
  if (run.orders().is_held()) view.paused_by = run.orders().pause()->by;
  const std::vector<bool> known = run.known_final();
  const std::vector<bool> skipped = run.known_skipped();
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    view.tasks.push_back(task_view(run, runs, executor, static_cast<TaskIndex>(i), {known[i], skipped[i]}));
  }
  fit(view);
  return view;
}

RunSummary summary_of(const Run& run, const RunStore& runs, const Executor& executor, Clock clock) {
  auto summary = shown<RunSummary>(run, runs, executor, clock);
  summary.tasks = static_cast<std::uint32_t>(run.tasks().size());
  const std::vector<bool> known = run.known_final();
  summary.version = run.version();
  summary.tasks_final = static_cast<std::uint32_t>(std::count(known.begin(), known.end(), true));
  return summary;
}

RunSummary summary_of(const RunView& view) {
  const auto is_final = [](const TaskView& task) {
    return task.state == TaskState::finished || task.state == TaskState::skipped;
  };
  return {.run = view.run,
          .name = view.name,
          .state = view.state,
          .waits_for = view.waits_for,
          .created = view.created,
          .tasks = static_cast<std::uint32_t>(view.tasks.size()),
          .tasks_final = static_cast<std::uint32_t>(std::ranges::count_if(view.tasks, is_final)),
          .epoch = view.epoch,
          .priority = view.priority,
          .left_s = view.left_s,
          .over = view.over};
}

}  // namespace trb::scheduler
