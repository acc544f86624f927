// SchedulerCore: the end of every step: what follows from the facts and the time.
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::advance(Step step) {
  if (!last_) return;  // not yet welcome: nothing can be sent
  last_ = step.now;
  end_runs(step);
  for (Run* run : book_.runs()) {
    std::erase_if(run->retry_at, [&](const auto& one) { return one.second <= step.now.mono; });
  }
  permit_attempt(step);
  executor_.tick(step.now, step.out);
  start_next(step);
  for (Run* run : book_.runs()) {
    confirm_abort(*run, step);
    decide(*run, step);
    abort_on_failure(*run, step);
    pass_overdue(*run, step);
    pass_on(*run, step);
    ask_needs(*run, step);
  }
  for (const Inbound& message : held_.take_late(step.now.mono)) {
    refuse(message, fail(Errc::unknown_run, "its run's definition, or its decision, did not come"), step);
  }
  tell_watchers(step);
}

void SchedulerCore::end_runs(Step step) {
  const std::vector<Run*> runs = book_.runs();  // a copy: burying changes the list
  for (Run* run : runs) {
    if (run->expired(step.now.utc)) end_run(*run, step);
  }
}

/// What is still owed of it is owed a day longer; then, or once nothing is owed, it is buried.
void SchedulerCore::end_run(Run& run, Step step) {
  run.duties.drop(DutyKind::baton);
  run.needs.clear();
  const UtcTime until = run.buried_until();
  const bool open = !run.duties.empty() && step.now.utc < until;
  if (open || executor_.runs(run.id())) return;
  const JournalTombstone fact{run.id(), state_of(run, executor_, step.now.utc), until.ns};
  step.out.record(fact);
  step.out.log(LogLevel::info, "run_over", "run " + run.id() + ": " + std::string(name_of(fact.state)));
  book_.bury(fact);
}

void SchedulerCore::permit_attempt(Step step) {
  if (!executor_.attempt()) return;
  const Run* run = book_.find(executor_.attempt()->execute.key.run);
  if (run == nullptr) return;
  const AttemptKey& key = executor_.attempt()->execute.key;
  const TaskIndex task = *run->index_of(key.task);
  if (run->aborted()) return executor_.allow(Permit::cancel, "the run is aborted");
  if (run->is_void(task, key.attempt)) {
    const std::string why = "epoch " + std::to_string(run->epoch()) + ": the task is for '" + run->robot_of(task) + "'";
    return executor_.allow(Permit::cancel, why + " now");
  }
  executor_.allow(run->expired(step.now.utc) ? Permit::no_more : Permit::go, {});
}

bool SchedulerCore::may_start(const Run& run, UtcTime now) const {
  return !run.aborted() && !run.expired(now) && !run.held() && run.troubles().empty();
}

void SchedulerCore::resume_attempt() {
  if (executor_.attempt()) return;
  for (const Run* run : book_.runs()) {
    if (const JournalStart* open = run->open_start()) return executor_.resume(run->attempt_for(*open));
  }
}

void SchedulerCore::start_next(Step step) {
  executor_.want_adapter(false);
  if (!settings_.has_robot) return;
  resume_attempt();
  if (executor_.attempt()) return;
  for (Run* run : book_.runs()) {
    if (!may_start(*run, step.now.utc)) continue;
    for (const TaskIndex task : run->startable()) {
      if (run->retry_at.contains(task)) continue;
      if (executor_.obstacle().empty()) return start(*run, task, step);
      executor_.want_adapter(true);
    }
  }
}

void SchedulerCore::start(Run& run, TaskIndex task, Step step) {
  const std::uint32_t attempt = run.next_attempt(task);
  if (attempt > kMaxAttempts) {
    return step.out.log(LogLevel::error, "not_started", "task '" + run.tasks()[task].id + "': 64 attempts were made");
  }
  if (const auto data = run.data_for(task); !data) {
    run.unbegun[task] = data.error().text();  // and fails with it, by decide()
    return;
  }
  JournalStart fact;
  fact.key = {run.id(), run.tasks()[task].id, 1, attempt};
  fact.epoch = run.epoch();
  fact.instance = executor_.adapter()->instance;
  fact.time = step.now.utc.ns;
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied)
    return step.out.log(LogLevel::error, "not_started", applied.error().text());
  executor_.begin(run.attempt_for(fact), step.now, step.out);
  tell_progress(run, fact.key, TaskState::initializing, step);
}

void SchedulerCore::tell_progress(const Run& run, const AttemptKey& key, TaskState state, Step step) {
  for (const std::string& cloud : run.clouds())
    step.out.information(cloud, TaskProgress{key, settings_.node, state, {}});
}

}  // namespace trb
