#include "services/scheduler/core/run_journal.hpp"

#include <algorithm>

#include "common/scenario/condition.hpp"

namespace trb::scheduler {
namespace {

/// A second choice on a task changes nothing; somebody has to know of it.
void report_double_choices(const Run& run, const HeldChoice& held, Step step) {
  for (const ChosenTask& chosen : held.choice.tasks) {
    const HeldChoice* known = run.facts().choice_on(*run.index_of(chosen.task));
    if (known == nullptr || known->record.payload == held.record.payload) continue;
    step.out.count("double_choice");
    step.out.log(LogLevel::error, "double_choice",
                 "run " + run.id() + ": '" + held.choice.by + "' has chosen twice on task '" + chosen.task +
                     "'; the first one holds");
  }
}

std::string decision_text(const Run& run, const Decision& decision) {
  std::string text = "run " + run.id() + ", epoch " + std::to_string(decision.epoch) + " by " +
                     (decision.person.empty() ? "the policy" : "'" + decision.person + "'");
  for (const TaskRuling& ruling : decision.tasks) {
    text += ", task '" + ruling.task + "' " + std::string(name_of(ruling.ruling)) + " '" + ruling.robot + "'";
  }
  return text;
}

}  // namespace

Run& RunJournal::add(std::unique_ptr<Run> run, bool submitted_here, Step step) {
  const JournalRun fact{run->definition().record(), submitted_here};
  step.out.record(fact);
  step.out.log(LogLevel::info, "run_known",
               "run " + run->id() + " of '" + run->definition().start().submitter +
                   "': " + std::to_string(run->tasks().size()) + " tasks");
  Run& added = runs_.add(std::move(run));
  const Status applied = added.apply(fact);
  if (!applied) step.out.log(LogLevel::error, "run_not_applied", applied.error().text());
  return added;
}

Run& RunJournal::learn(std::unique_ptr<Run> run, bool is_first, Step step) {
  Run& added = add(std::move(run), false, step);
  const bool is_new = is_first && is_young(added, step) && !may_be_lost(added, step);
  if (!added.epochs().judges_here() || is_new) return added;
  keep_recovery(added, node_, kRecovers, step);
  if (is_first) keep_recovery(added, node_, kFirstPass, step);
  step.out.log(LogLevel::warning, "run_recovered",
               "run " + added.id() + " is not in this node's journal: its members are asked for all that they hold");
  return added;
}

void RunJournal::note_first(Run& run, Step step) {
  if (run.is_recovering() && !run.recovery().is_first_passed()) keep_recovery(run, node_, kFirstPass, step);
  look_again(run, step);
}

/// Its word alone counts only of a run that has just been made: a stolen submitter of an older one could say so to a
/// node with an empty disk, which would then decide against what it had signed. But a node that was cut off for long
/// hears late of a new run, and must not wait for who is off.
void RunJournal::look_again(Run& run, Step step) {
  if (!run.is_recovering() || !run.recovery().is_first_passed() || run.has_signed() || may_be_lost(run, step)) return;
  const bool is_over = is_young(run, step) || run.recovery().are_away(run.silent_members());
  if (is_over) keep_recovery(run, node_, kHasTold, step);
}

bool RunJournal::is_young(const Run& run, Step step) {
  constexpr std::int64_t kYoung = 600'000'000'000;  // two clocks may be apart by minutes
  const std::int64_t age = step.steady.ns - run.definition().start().created;
  return age < kYoung && age > -kYoung;
}

void RunJournal::keep_told(Run& run, const std::string& member, Step step) {
  const std::vector<std::string> silent = run.silent_members();
  const bool is_awaited = run.is_recovering() && std::ranges::find(silent, member) != silent.end();
  if (is_awaited) keep_recovery(run, member, kHasTold, step);
}

bool RunJournal::may_be_lost(const Run& run, Step step) const {
  return lost_.may_have_held(run.definition().start().created, step.now.utc);
}

void RunJournal::keep_recovery(Run& run, const std::string& node, std::string_view what, Step step) {
  const JournalDelivered fact{run.id(), node, std::string(what), {}, run.epochs().current()};
  step.out.record(fact);
  if (auto applied = run.apply(fact); !applied) {
    step.out.log(LogLevel::error, "recovery_not_applied", applied.error().text());
  }
}

Status RunJournal::note_submitted(Run& run, Step step) {
  const JournalRun fact{run.definition().record(), true};
  step.out.record(fact);
  return run.apply(fact);
}

void RunJournal::keep_result(Run& run, HeldResult held, Step step) {
  const TaskIndex task = *run.index_of(held.result.key.task);
  const bool was_double = run.results().finished_twice(task);
  const SignedRecord record = held.record;
  const TaskResult result = held.result;
  if (!run.add(std::move(held))) return;
  // Its robot tries by this timer; on other nodes it says that the task is not due meanwhile.
  if (run.results().of(task)->result.key == result.key) run.await_retry(task, step.now.mono, step.steady);
  step.out.record(JournalResult{record});
  const std::string text = "run " + run.id() + ", task '" + result.key.task + "' on '" + result.robot + "'";
  step.out.log(LogLevel::info, "result_kept", text + ": " + std::string(name_of(result.outcome)));
  if (was_double || !run.results().finished_twice(task)) return;
  step.out.count("double_execution");
  step.out.log(LogLevel::error, "double_execution", text + " has two different results; its judge holds the run");
}

void RunJournal::keep_choice(Run& run, HeldChoice held, Step step) {
  report_double_choices(run, held, step);
  const SignedRecord record = held.record;
  const Choice choice = held.choice;
  if (!run.add(std::move(held))) return;
  step.out.record(JournalChoice{record});
  for (const ChosenTask& chosen : choice.tasks) {
    const Condition& condition = run.tasks()[*run.index_of(chosen.task)].when.front();
    step.out.log(
        LogLevel::info, "choice_kept",
        "run " + run.id() + ": task '" + chosen.task + "': " + verdict_text(condition, choice.node, choice.reading));
  }
}

void RunJournal::keep_decision(Run& run, const SignedRecord& record, bool here, Step step) {
  const JournalDecision fact{record, here};
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "decision_not_applied", applied.error().text());
  }
  step.out.record(fact);
  step.out.log(LogLevel::warning, "decision_kept", decision_text(run, run.epochs().decisions().back()));
}

void RunJournal::keep_end(Run& run, const SignedRecord& end, Step step) {
  const JournalEnd fact{end};
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "end_not_applied", applied.error().text());
  }
  step.out.record(fact);
  step.out.log(LogLevel::info, "run_finished", "run " + run.id() + ", says '" + run.definition().rule().judge() + "'");
}

void RunJournal::keep_delivery(Run& run, DeliveryKind kind, const Inbound& from, std::vector<TaskIndex> tasks,
                               std::uint32_t epoch, Step step) {
  if (!run.deliveries().settle(kind, from.source, tasks)) {
    return step.out.count("late." + std::string(subtype_of(from.body)));
  }
  JournalDelivered fact;
  fact.run = run.id();
  fact.to = from.source;
  fact.what = name_of(kind);
  fact.tasks = std::move(tasks);
  fact.epoch = epoch;
  // If it is lost, the delivery is sent again and answered as a repeat, as if this answer had been lost on its way.
  // But a person is told ABORTED once every member has confirmed it, and that must stay so.
  if (kind == DeliveryKind::abort) {
    step.out.record(fact);
  } else {
    step.out.record_later(fact);
  }
  if (auto applied = run.apply(fact); !applied) {
    step.out.log(LogLevel::error, "delivery_not_applied", applied.error().text());
  }
}

void RunJournal::give_up(Run& run, const std::string& to, Step step) {
  const std::vector<PendingDelivery> owed = run.deliveries().pending().owed_to(to);
  for (const PendingDelivery& one : owed) {
    const JournalDelivered fact{run.id(), to, std::string(name_of(one.kind)), one.tasks, run.epochs().current()};
    step.out.record(fact);
    if (auto applied = run.apply(fact); !applied) {
      step.out.log(LogLevel::error, "delivery_not_applied", applied.error().text());
    }
  }
  if (owed.empty()) return;
  step.out.log(LogLevel::warning, "member_gone",
               "run " + run.id() + ": '" + to + "' is revoked, and is owed nothing more");
}

Status RunJournal::keep_abort(Run& run, const SignedRecord& order, bool here, Step step) {
  if (run.orders().is_aborted()) return Done{};
  const JournalAbort fact{order, here};
  if (auto applied = run.apply(fact); !applied) return applied;
  step.out.record(fact);
  const auto is = decode<AbortOrder>(order.payload.bytes);
  step.out.log(LogLevel::warning, "run_aborted", "run " + run.id() + " by '" + is->by + "': " + is->reason);
  return Done{};
}

Status RunJournal::keep_pause(Run& run, const SignedRecord& order, bool here, Step step) {
  const auto is = run.checks().received_pause(order);
  if (!is) return is.error();
  run.outbid(*is);
  if (!run.orders().is_newer(*is)) return Done{};
  const JournalPause fact{order, here};
  if (auto applied = run.apply(fact); !applied) return applied;
  step.out.record(fact);
  step.out.log(LogLevel::warning, is->paused ? "run_held" : "run_goes_on",
               "run " + run.id() + " by '" + is->by + "': " + is->reason);
  return Done{};
}

Status RunJournal::keep_orders(Run& run, const std::vector<SignedRecord>& orders, Step step) {
  for (const SignedRecord& order : orders) {
    if (auto checked = run.checks().order(order); !checked) return checked;
  }
  if (run.orders().has_ended()) return Done{};
  for (const SignedRecord& order : orders) {
    const bool aborts = order.kind == kSignedRunAbort;
    auto kept = aborts ? keep_abort(run, order, false, step) : keep_pause(run, order, false, step);
    if (!kept) return kept;
  }
  return Done{};
}

Status RunJournal::keep_decisions(Run& run, const std::vector<SignedRecord>& records, Step step) {
  for (const SignedRecord& record : records) {
    const auto claimed = decode<Decision>(record.payload.bytes);
    if (!claimed) return claimed.error();
    if (claimed->epoch <= run.epochs().current()) continue;  // each newer one is checked against what is known
    if (auto checked = run.decision_checks().decision(record); !checked) return checked.error();
    keep_decision(run, record, false, step);
  }
  return Done{};
}

}  // namespace trb::scheduler
