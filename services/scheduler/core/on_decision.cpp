// SchedulerCore: decisions, which make the next epoch, and tasks that are asked back before one.
#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

bool SchedulerCore::defer_for_decisions(Run& run, std::uint32_t epoch, const Inbound& from, Step step) {
  if (epoch <= run.epoch()) return false;
  const bool can_ask = !handing_out_ && from.reply_to == 0 && from.source != settings_.node;
  if (!can_ask || !deferred_.add(run.id(), from, step.now.mono)) {
    refuse(from,
           fail(Errc::conflict, "run " + run.id() + ": epoch " + std::to_string(epoch) + " is not known here yet"),
           step);
    return true;
  }
  run.asked_decisions.insert(from.source);
  step.out.request(from.source, NeedDefinition{run.id(), run.start().digest});
  return true;
}

void SchedulerCore::keep_decision(Run& run, const SignedRecord& record, bool here, Step step) {
  const JournalDecision fact{record, here};
  if (auto applied = run.apply(fact); !applied) {
    return step.out.log(LogLevel::error, "decision_not_applied", applied.error().text());
  }
  step.out.record(fact);
  const Decision& decision = run.decisions().back();
  std::string text = "run " + run.id() + ", epoch " + std::to_string(decision.epoch) + " by " +
                     (decision.person.empty() ? "the policy" : "'" + decision.person + "'");
  for (const TaskRuling& ruling : decision.tasks) {
    text += ", task '" + ruling.task + "' " + std::string(name_of(ruling.ruling)) + " '" + ruling.robot + "'";
  }
  step.out.log(LogLevel::warning, "decision_kept", text);
}

Status SchedulerCore::take_decisions(Run& run, const std::vector<SignedRecord>& records, Step step) {
  for (const SignedRecord& record : records) {
    const auto claimed = decode<Decision>(record.payload.bytes);
    if (!claimed) return claimed.error();
    if (claimed->epoch <= run.epoch()) continue;  // check_decision holds what is known against each newer one
    if (auto checked = run.check_decision(record); !checked) return checked.error();
    keep_decision(run, record, false, step);
  }
  return Done{};
}

void SchedulerCore::handle(const RunDecision& body, const Inbound& from, Step step) {
  const auto claimed = decode<Decision>(body.decision.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = run_or_defer(claimed->run, claimed->digest, from, step);
  if (run == nullptr) return;
  const bool here = from.source == settings_.node;
  if (claimed->epoch >= 2 && claimed->epoch <= run->epoch()) {
    if (run->decision_records()[claimed->epoch - 2].payload != body.decision.payload) {
      const std::string what = "run " + run->id() + ": epoch " + std::to_string(claimed->epoch);
      return refuse(from, fail(Errc::conflict, what + " was decided otherwise", "look at the run, decide anew"), step);
    }
  } else {
    if (claimed->epoch >= 2 && defer_for_decisions(*run, claimed->epoch - 1, from, step)) return;
    if (here && (run->aborted() || run->ended() || run->expired(step.steady))) {
      return refuse(from, fail(Errc::conflict, "run " + run->id() + " is over: nothing is decided on it"), step);
    }
    const auto checked = run->check_decision(body.decision);
    if (!checked) return refuse(from, checked.error(), step);
    if (const Status grounds = here ? run->check_grounds(*checked) : Done{}; !grounds) {
      return refuse(from, grounds.error(), step);
    }
    keep_decision(*run, body.decision, here, step);
  }
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + ": epoch " + std::to_string(claimed->epoch)});
  } else {
    step.out.information(from.source, DecisionJournaled{run->id(), run->epoch()});
  }
}

void SchedulerCore::handle(const DecisionJournaled& body, const Inbound& from, Step step) {
  Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (body.epoch < run->epoch()) return step.out.count("late.decision_journaled");
  delivered(*run, DeliveryKind::decision, from, {}, run->epoch(), step);
}

void SchedulerCore::handle(const ReleaseTasks& body, const Inbound& from, Step step) {
  // Whom the run has not reached yet gives its tasks back all the same: the run may be paused long before it does.
  Run* run = run_or_defer(body.run, {}, from, step);
  if (run == nullptr) return;
  const std::string name = "run " + run->id() + ": ";
  if (from.source != run->decider()) {
    return refuse(from, fail(Errc::not_permitted, name + "only its decider asks for tasks back"), step);
  }
  if (body.epoch != run->epoch()) {
    return refuse(from, fail(Errc::conflict, name + "this is epoch " + std::to_string(run->epoch())), step);
  }
  for (const TaskIndex task : body.tasks) {
    if (task >= run->tasks().size() || run->robot_of(task) != settings_.node) {
      return refuse(from, fail(Errc::bad_value, name + "task " + std::to_string(task) + " is not this node's"), step);
    }
  }
  run->asked_back.insert(body.tasks.begin(), body.tasks.end());
  step.out.reply(from, Ack{"accepted", "what has not begun is given back"});
}

}  // namespace trb
