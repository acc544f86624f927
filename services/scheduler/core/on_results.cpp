// SchedulerCore: signed results, asked for, told and acknowledged.
#include "services/scheduler/core/passing.hpp"
#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::keep_result(Run& run, HeldResult held, Step step) {
  const TaskIndex task = *run.index_of(held.result.key.task);
  const bool was_double = run.results().finished_twice(task);
  const SignedRecord record = held.record;
  const TaskResult result = held.result;
  if (!run.add(std::move(held))) return;
  if (result.robot == settings_.node && result.outcome == TaskOutcome::retriable && run.current(task) == nullptr) {
    run.retry_at[task] = step.now.mono + run.retry_pause(task);
  }
  step.out.record(JournalResult{record});
  const std::string text = "run " + run.id() + ", task '" + result.key.task + "' on '" + result.robot + "'";
  step.out.log(LogLevel::info, "result_kept", text + ": " + std::string(name_of(result.outcome)));
  if (was_double || !run.results().finished_twice(task)) return;
  step.out.count("double_execution");
  step.out.log(LogLevel::error, "double_execution", text + " has two different results; the run is paused");
}

void SchedulerCore::handle(const NeedResults& body, const Inbound& from, Step step) {
  const Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  step.out.reply(from, pack_results(*run, body.tasks));
}

void SchedulerCore::handle(const Results& body, const Inbound& from, Step step) {
  Run* run = run_or_defer(body.run, {}, from, step);
  if (run == nullptr) return;
  ResultsJournaled journaled;
  Status all = Done{};
  for (const SignedRecord& record : body.choices) {
    auto held = run->check_choice(record);
    if (held) {
      keep_choice(*run, std::move(*held), step);
    } else {
      all = held.error();
    }
  }
  for (const SignedRecord& record : body.results) {
    auto held = run->check_result(record);
    if (!held) {
      all = held.error();
      continue;
    }
    journaled.keys.push_back(held->result.key);
    keep_result(*run, std::move(*held), step);
  }
  if (!all) refuse(from, all.error(), step);
  if (from.reply_to != 0) {
    // An answer without anything to keep: that giver does not hold what its baton spoke of.
    if (journaled.keys.empty()) run->forget_needs(from.source);
    return;
  }
  if (!journaled.keys.empty()) step.out.information(from.source, std::move(journaled));
}

void SchedulerCore::handle(const ResultsJournaled& body, const Inbound& from, Step step) {
  std::map<std::string, std::vector<TaskIndex>> by_run;
  for (const AttemptKey& key : body.keys) {
    const Run* run = runs_.find(key.run);
    const auto task = run == nullptr ? std::nullopt : run->index_of(key.task);
    // What has been replaced by another attempt since it was sent is still owed.
    const bool current = task && run->results().of(*task) != nullptr && run->results().of(*task)->result.key == key;
    if (current) {
      by_run[key.run].push_back(*task);
    } else {
      step.out.count("late.results_journaled");
    }
  }
  for (auto& [id, tasks] : by_run) delivered(*runs_.find(id), DeliveryKind::results, from, std::move(tasks), 1, step);
}

void SchedulerCore::handle(const TaskProgress& body, const Inbound& from, Step step) {
  Run* run = run_for(body.key.run, from, step);
  if (run == nullptr) return;
  const auto task = run->index_of(body.key.task);
  const bool chooses = task && body.state == TaskState::waiting && run->is_conditional(*task);
  const bool theirs = task && (chooses ? run->chooser_of(*task) : run->robot_of(*task)) == from.source;
  if (!theirs || body.robot != from.source) {
    return refuse(from, fail(Errc::not_permitted, "progress of a task that is another's"), step);
  }
  const bool shown =
      body.state == TaskState::initializing || body.state == TaskState::running || body.state == TaskState::paused;
  // An earlier attempt's result tells nothing of this one.
  const HeldResult* held = run->results().of(*task);
  const bool late = held != nullptr && (is_final(held->result.outcome) || held->result.key.attempt >= body.key.attempt);
  if (shown && !late) {
    run->progress[*task] = body.state;
    run->waits.erase(*task);
  } else if (chooses && !late && run->choice_on(*task) == nullptr) {
    run->waits[*task] = body.detail;
  } else {
    step.out.count("late.task_progress");
  }
}

}  // namespace trb
