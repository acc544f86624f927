#include "services/scheduler/core/handlers/decision_handler.hpp"

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/waits.hpp"

namespace trb::scheduler {
namespace {

/// A decision of a known epoch must be exactly the known one.
Status check_known(const Run& run, std::uint32_t epoch, const SignedRecord& record) {
  if (run.epochs().records()[epoch - 2].payload == record.payload) return Done{};
  return fail(Errc::conflict, "run " + run.id() + ": epoch " + std::to_string(epoch) + " was decided otherwise",
              "look at the run, decide anew");
}

}  // namespace

Status DecisionHandler::keep(Run& run, const SignedRecord& record, bool here, Step step) {
  if (here && !run.is_open(step.steady)) {
    return fail(Errc::conflict, "run " + run.id() + " is over: nothing is decided on it");
  }
  if (here && run.is_recovering()) {
    // Nothing is wrong with it: it may be given again, unchanged or not, once the members have answered.
    return fail(Errc::timeout, "run " + run.id() + ": what was decided on it is not known here yet",
                "it waits for " + recovery_text(run));
  }
  const auto checked = run.decision_checks().decision(record);
  if (!checked) return checked.error();
  const Status grounds = here ? run.decision_checks().grounds(*checked, run.facts()) : Done{};
  if (grounds) journal_.keep_decision(run, record, here, step);
  return grounds;
}

void DecisionHandler::handle(const RunDecision& body, const Inbound& from, Step step) {
  const auto claimed = decode<Decision>(body.decision.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = lookup_.find_or_defer(claimed->run, claimed->digest, from, step);
  if (run == nullptr) return;
  const bool here = from.source == node_;
  const bool is_known = claimed->epoch >= 2 && claimed->epoch <= run->epochs().current();
  if (!is_known && claimed->epoch >= 2 && lookup_.defer_for_decisions(*run, claimed->epoch - 1, from, step)) return;
  const Status taken =
      is_known ? check_known(*run, claimed->epoch, body.decision) : keep(*run, body.decision, here, step);
  if (!taken) return refuse(from, taken.error(), step);
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + ": epoch " + std::to_string(claimed->epoch)});
  } else {
    step.out.information(from.source, DecisionJournaled{run->id(), run->epochs().current()});
  }
}

void DecisionHandler::handle(const DecisionJournaled& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  const std::uint32_t epoch = run->epochs().current();
  if (body.epoch < epoch) return step.out.count("late.decision_journaled");
  journal_.keep_delivery(*run, DeliveryKind::decision, from, {}, epoch, step);
}

Status DecisionHandler::check_release(const Run& run, const ReleaseTasks& body, const Inbound& from) const {
  const std::string name = "run " + run.id() + ": ";
  if (from.source != run.definition().rule().decider()) {
    return fail(Errc::not_permitted, name + "only its decider asks for tasks back");
  }
  if (body.epoch != run.epochs().current()) {
    return fail(Errc::conflict, name + "this is epoch " + std::to_string(run.epochs().current()));
  }
  for (const TaskIndex task : body.tasks) {
    if (task >= run.tasks().size() || run.epochs().robot_of(task) != node_) {
      return fail(Errc::bad_value, name + "task " + std::to_string(task) + " is not this node's");
    }
  }
  return Done{};
}

void DecisionHandler::handle(const ReleaseTasks& body, const Inbound& from, Step step) {
  // A node that does not know the run yet also gives its tasks back: the run may be paused long before it reaches it.
  Run* run = lookup_.find_or_defer(body.run, {}, from, step);
  if (run == nullptr) return;
  if (auto checked = check_release(*run, body, from); !checked) return refuse(from, checked.error(), step);
  run->work().withheld().give_back(body.tasks, body.stop);
  step.out.reply(from, Ack{"accepted", body.stop ? "what runs is stopped" : "what has not begun is given back"});
}

}  // namespace trb::scheduler
