#include "services/scheduler/core/handlers/result_handler.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "services/scheduler/core/delivery_sender.hpp"
#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {
namespace {

/// The states that a robot's node reports during an attempt.
bool is_under_way(TaskState state) {
  return state == TaskState::initializing || state == TaskState::running || state == TaskState::paused;
}

/// Does the node that evaluates a condition report that the task waits for it?
bool tells_of_condition(const Run& run, TaskIndex task, const TaskProgress& body) {
  return body.state == TaskState::waiting && run.definition().is_conditional(task);
}

/// The record may be right in an epoch that this node does not know yet.
bool is_of_later_epoch(const Run& run, const SignedRecord& record) {
  const auto claimed = decode<TaskResult>(record.payload.bytes);
  return claimed && claimed->epoch > run.epochs().current();
}

/// What an answer says of the tasks that its sender was asked for.
void settle_requests(Run& run, const Results& answer, const std::vector<AttemptKey>& kept, const Inbound& from,
                     MonotonicTime now) {
  AwaitedRecords& awaited = run.work().awaited();
  for (const AttemptKey& key : kept) awaited.settle_result(*run.index_of(key.task), from.source);
  if (answer.results.empty()) awaited.settle_without_result(from.source, now);
}

std::vector<TaskIndex> tasks_of_choices(const Run& run, const Results& answer) {
  std::vector<TaskIndex> out;
  for (const SignedRecord& record : answer.choices) {
    const auto claimed = decode<Choice>(record.payload.bytes);
    if (!claimed) continue;
    for (const ChosenTask& chosen : claimed->tasks) {
      if (const auto task = run.index_of(chosen.task)) out.push_back(*task);
    }
  }
  return out;
}

/// Has everything that is owed of the task been journaled there? What another attempt's result has replaced, or joined,
/// since it was sent is still owed.
bool is_proven(const Run& run, TaskIndex task, const std::vector<AttemptKey>& keys) {
  const std::vector<const HeldResult*> proof = run.results().proof_of(task, run.epochs().self());
  return !proof.empty() && std::ranges::all_of(proof, [&](const HeldResult* held) {
    return std::ranges::find(keys, held->result.key) != keys.end();
  });
}

/// The result of an earlier attempt says nothing about this one.
bool is_late(const Run& run, TaskIndex task, const TaskProgress& body) {
  const HeldResult* held = run.results().of(task);
  return held != nullptr && (is_final(held->result.outcome) || held->result.key.attempt >= body.key.attempt);
}

}  // namespace

void ResultHandler::handle(const NeedResults& body, const Inbound& from, Step step) {
  const Run* run = lookup_.find(body.run, from, step);
  if (run != nullptr) step.out.reply(from, pack_results(*run, body.tasks));
}

Status ResultHandler::keep_choices(Run& run, const Results& body, Step step) {
  Status all = Done{};
  for (const SignedRecord& record : body.choices) {
    auto held = run.checks().choice(record);
    if (held) {
      journal_.keep_choice(run, std::move(*held), step);
    } else {
      all = held.error();
    }
  }
  return all;
}

Status ResultHandler::keep_results(Run& run, const Results& body, std::vector<AttemptKey>& kept, Step step) {
  Status all = Done{};
  for (const SignedRecord& record : body.results) {
    auto held = runs_.received_result(run, record);
    if (held) {
      kept.push_back(held->result.key);
      journal_.keep_result(run, std::move(*held), step);
    } else {
      all = held.error();
    }
  }
  return all;
}

void ResultHandler::handle(const Results& body, const Inbound& from, Step step) {
  Run* run = lookup_.find_or_defer(body.run, {}, from, step);
  if (run == nullptr) return;
  ResultsJournaled journaled{{}, true};
  const Status choices = keep_choices(*run, body, step);
  const Status results = keep_results(*run, body, journaled.keys, step);
  if (!results) {
    refuse(from, results.error(), step);
  } else if (!choices) {
    refuse(from, choices.error(), step);
  }
  const auto later = [&](const SignedRecord& record) { return is_of_later_epoch(*run, record); };
  if (std::ranges::any_of(body.results, later)) lookup_.request_decisions(*run, from.source, step);
  if (from.reply_to != 0) {
    settle_requests(*run, body, journaled.keys, from, step.now.mono);
    if (run->is_recovering()) note_told(*run, body, from, step);
  } else if (!journaled.keys.empty()) {
    step.out.information(from.source, std::move(journaled));
  }
}

/// What is not believed counts as told, too; what an unknown decision may make right is asked for again. An answer
/// without results has as many choices as fit: there is no result of their tasks, but there may be more choices.
void ResultHandler::note_told(Run& run, const Results& body, const Inbound& from, Step step) {
  std::vector<TaskIndex> tasks;
  for (const SignedRecord& record : body.results) {
    const auto claimed = decode<TaskResult>(record.payload.bytes);
    const auto task = claimed ? run.index_of(claimed->key.task) : std::nullopt;
    if (task && !is_of_later_epoch(run, record)) tasks.push_back(*task);
  }
  if (body.results.empty()) tasks = tasks_of_choices(run, body);
  if (tasks.empty() && !(body.results.empty() && body.choices.empty())) return;
  if (run.recovery().note_results(from.source, tasks, run.tasks().size())) journal_.keep_told(run, from.source, step);
}

void ResultHandler::handle(const ResultsJournaled& body, const Inbound& from, Step step) {
  std::map<std::string, std::set<TaskIndex>> by_run;
  for (const AttemptKey& key : body.keys) {
    Run* run = runs_.find(key.run);
    if (run != nullptr) run->deliveries().note_reads_short(from.source, body.reads_short);
    const auto task = run == nullptr ? std::nullopt : run->index_of(key.task);
    if (task && is_proven(*run, *task, body.keys)) {
      by_run[key.run].insert(*task);
    } else {
      step.out.count("late.results_journaled");
    }
  }
  for (const auto& [id, tasks] : by_run) {
    journal_.keep_delivery(*runs_.find(id), DeliveryKind::results, from, {tasks.begin(), tasks.end()}, 1, step);
  }
}

void ResultHandler::handle(const TaskProgress& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.key.run, from, step);
  if (run == nullptr) return;
  const auto task = run->index_of(body.key.task);
  const bool chooses = task && tells_of_condition(*run, *task, body);
  const bool theirs =
      task && (chooses ? run->epochs().chooser_of(*task) : run->epochs().robot_of(*task)) == from.source;
  if (!theirs || body.robot != from.source) {
    return refuse(from, fail(Errc::not_permitted, "progress of a task that is another's"), step);
  }
  lookup_.tell_aborted(*run, from, step);
  const bool late = is_late(*run, *task, body);
  if (is_under_way(body.state) && !late) {
    run->reports().note_progress(*task, body.state, body.detail);
    run->work().timers().drop_retry(*task);  // it is tried again
  } else if (chooses && !late && run->facts().choice_on(*task) == nullptr) {
    run->reports().note_wait(*task, body.detail);
  } else {
    step.out.count("late.task_progress");
  }
}

}  // namespace trb::scheduler
