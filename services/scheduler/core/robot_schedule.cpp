#include "services/scheduler/core/robot_schedule.hpp"

#include <algorithm>
#include <limits>

#include "services/scheduler/core/handlers/robot_handler.hpp"
#include "services/scheduler/core/run/drafts.hpp"

namespace trb::scheduler {

void RobotSchedule::resume_attempt() {
  if (executor_.attempt()) return;
  for (const Run* run : runs_.runs()) {
    if (const JournalStart* open = run->facts().open_start()) return executor_.resume(attempt_for(*run, *open));
  }
}

void RobotSchedule::permit_attempt(Step step) {
  if (!executor_.attempt()) return;
  const AttemptKey& key = executor_.attempt()->execute.key;
  const Run* run = runs_.find(key.run);
  if (run == nullptr) return;
  const Allowed now = allowed(*run, key, step);
  // Who was too late once stays so.
  if (now.permit == Permit::go && executor_.attempt()->permit == Permit::too_late) return;
  executor_.allow(now.permit, now.why);
}

RobotSchedule::Allowed RobotSchedule::allowed(const Run& run, const AttemptKey& key, Step step) const {
  const TaskIndex task = *run.index_of(key.task);
  if (run.orders().is_aborted()) return {Permit::cancel, "the run is aborted"};
  if (run.orders().has_ended()) return {Permit::cancel, "the run has FINISHED"};
  if (run.epochs().is_void(task, key.attempt)) {
    return {Permit::cancel, "epoch " + std::to_string(run.epochs().current()) + ": the task is for '" +
                                run.epochs().robot_of(task) + "' now"};
  }
  if (run.definition().expired(step.steady)) return {Permit::no_more, "the run has expired"};
  const std::string& decider = run.definition().rule().decider();
  if (run.work().withheld().is_to_stop(task)) {
    return {Permit::stop, "asked back by '" + decider + "': somebody says that the robot stands"};
  }
  if (run.work().withheld().is_asked_back(task)) {
    return {Permit::give_back, "given back to '" + decider + "', never begun"};
  }
  if (run.orders().is_held()) return {Permit::hold, "the run is held"};
  if (executor_.is_refused() && DueTasks::is_late(run, task, step)) {
    return {Permit::too_late, due_.late_text(run, task)};
  }
  return {Permit::go, {}};
}

/// The higher priority first; of two alike the one whose task this robot began longest ago, so that no run starves the
/// younger ones; then the older.
std::vector<Run*> RobotSchedule::by_turn() const {
  std::vector<Run*> out = runs_.runs();
  constexpr MonotonicTime kNever{std::numeric_limits<std::int64_t>::min()};
  const auto turn = [&](const Run* run) {
    return std::pair(kMaxPriority - run->definition().start().priority, run->work().served().value_or(kNever));
  };
  std::ranges::stable_sort(out, {}, turn);
  return out;
}

void RobotSchedule::start_next(Step step) {
  executor_.want_adapter(false);
  resume_attempt();
  if (executor_.attempt() || lost_.open()) return;
  for (Run* run : by_turn()) {
    if (run->may_start(step.steady) && start_of(*run, step)) return;
  }
}

bool RobotSchedule::start_of(Run& run, Step step) {
  for (const TaskIndex task : run.open_tasks().startable()) {
    if (run.work().timers().waits(task)) continue;
    if (executor_.obstacle(run.tasks()[task].skill).empty()) {
      start(run, task, step);
      return true;
    }
    executor_.want_adapter(true);
    // It fails with that at the step's end.
    if (DueTasks::is_late(run, task, step)) run.work().withheld().fail(task, due_.late_text(run, task));
  }
  return false;
}

void RobotSchedule::start(Run& run, TaskIndex task, Step step) {
  if (const auto data = data_for(run, task); !data) {
    return run.work().withheld().fail(task, data.error().text());  // at the step's end
  }
  JournalStart fact;
  fact.key = {run.id(), run.tasks()[task].id, 1, run.facts().next_attempt(task)};
  fact.epoch = run.epochs().current();
  fact.instance = executor_.adapter()->instance;
  fact.time = step.now.utc.ns;
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "not_started", applied.error().text());
  }
  run.work().note_served(step.now.mono);
  executor_.begin(attempt_for(run, fact), step.now, step.out);
  notify_progress(run, fact.key, TaskState::initializing, step);
}

}  // namespace trb::scheduler
