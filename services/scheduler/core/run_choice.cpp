// Run: what becomes of a task whose predecessors are final: conditions, choices on them, and what is SKIPPED.
#include <algorithm>

#include "common/scenario/condition.hpp"
#include "proto/body.hpp"
#include "proto/value.hpp"
#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {

Result<HeldChoice> Run::check_choice(const SignedRecord& record) const {
  const auto signer = members_.find(record.signer);
  if (signer == members_.end()) {
    return fail(Errc::not_permitted, "run " + id() + ": '" + record.signer + "' is no member");
  }
  auto choice = open_record<Choice>(record, kSignedChoice, signer->second);
  if (!choice) return choice.error();
  const std::string name = "run " + id() + ": choice of '" + record.signer + "': ";
  if (choice->run != id() || choice->digest != start_.digest) return fail(Errc::conflict, name + "of another run");
  if (choice->epoch == 0 || choice->epoch > epoch()) return fail(Errc::conflict, name + "of another epoch");
  if (choice->by != record.signer) return fail(Errc::source_mismatch, name + "it names another node");
  if (choice->tasks.empty()) return fail(Errc::bad_value, name + "on no task");
  for (const ChosenTask& chosen : choice->tasks) {
    const auto task = index_of(chosen.task);
    if (!task || !is_conditional(*task) || chosen.iteration != 1) {
      return fail(Errc::bad_value, name + "there is none on task '" + chosen.task + "'");
    }
    if (robot_in(trb::chooser_of(start_.scenario, *task), choice->epoch) != record.signer) {
      return fail(Errc::not_permitted, name + "on task '" + chosen.task + "' it is another's");
    }
    const Condition& condition = tasks()[*task].when.front();
    const bool bound = !condition.of.empty() && condition.identity.empty();
    const bool elsewhere = bound && choice->node != condition.of;
    const bool other = !condition.identity.empty() && choice->reading.identity != condition.identity;
    if (elsewhere || other) return fail(Errc::bad_value, name + "on task '" + chosen.task + "' by another sensor");
    if (!believe(condition, choice->reading) || holds(condition, choice->reading) != chosen.holds) {
      return fail(Errc::bad_value, name + "on task '" + chosen.task + "' its own reading says otherwise");
    }
  }
  return HeldChoice{record, std::move(*choice)};
}

const HeldChoice* Run::choice_on(TaskIndex task) const {
  const auto found = choices_.find(task);
  return found == choices_.end() ? nullptr : found->second.get();
}

bool Run::all_before_final(TaskIndex task) const {
  const auto& after = tasks()[task].after;
  return std::all_of(after.begin(), after.end(), [&](TaskIndex before) { return results_.has_final(before); });
}

bool Run::takes_along(TaskIndex task) const {
  return results_.is_skipped(task) && !results_.of(task)->result.goes_on;
}

bool Run::all_before_skipped(TaskIndex task) const {
  const auto& after = tasks()[task].after;
  return !after.empty() &&
         std::all_of(after.begin(), after.end(), [&](TaskIndex before) { return takes_along(before); });
}

Fate Run::fate_of(TaskIndex task) const {
  const bool is_skipped = robot_of(task) == decider_ && is_ruled(task);  // by a decision
  if (is_skipped || all_before_skipped(task)) return Fate::skipped;
  const Fate on = is_unbound(task) ? Fate::binds : Fate::goes;
  if (!is_conditional(task)) return on;
  const HeldChoice* held = choice_on(task);
  if (held == nullptr) return Fate::undecided;
  return holds(tasks()[task].when.front(), held->choice.reading) ? on : Fate::skipped;
}

std::vector<TaskIndex> Run::own_tasks_that(Fate fate) const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : own_tasks_) {
    if (begun(task) || current(task) != nullptr || asked_back.contains(task) || unbegun.contains(task)) continue;
    if (all_before_final(task) && fate_of(task) == fate) out.push_back(task);
  }
  return out;
}

std::vector<TaskIndex> Run::to_choose() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : concern_) {
    if (!chooses_here(task) || current(task) != nullptr) continue;
    if (all_before_final(task) && fate_of(task) == Fate::undecided) out.push_back(task);
  }
  return out;
}

TaskResult Run::own_result(TaskIndex task, TaskOutcome outcome, UtcTime now) const {
  TaskResult out;
  out.key = {id(), tasks()[task].id, 1, next_attempt(task)};
  out.digest = start_.digest;
  out.epoch = epoch();
  out.robot = self_;
  out.outcome = outcome;
  out.started = now.ns;
  out.ended = now.ns;
  return out;
}

TaskResult Run::released_result(TaskIndex task, UtcTime now) const {
  TaskResult out = own_result(task, TaskOutcome::released, now);
  out.reason = is_unbound(task) ? "its robot is to be chosen" : "given back to '" + decider_ + "', never begun";
  return out;
}

TaskResult Run::unbegun_result(TaskIndex task, const std::string& why, UtcTime now) const {
  const OnFailure then = tasks()[task].on_failure;
  const bool passes = then == OnFailure::skip || then == OnFailure::continue_;
  TaskResult out = own_result(task, passes ? TaskOutcome::skipped : TaskOutcome::failed, now);
  out.goes_on = then == OnFailure::continue_;
  out.reason = cut_utf8(why, 1024);
  return out;
}

TaskResult Run::skipped_result(TaskIndex task, UtcTime now) const {
  TaskResult out = own_result(task, TaskOutcome::skipped, now);
  const HeldChoice* held = choice_on(task);
  if (robot_of(task) == decider_ && is_ruled(task)) {
    out.goes_on = tasks()[task].on_failure == OnFailure::continue_;
    const Decision& by = decisions_[since_[task] - 2];
    out.reason = cut_utf8("by decision of " + (by.person.empty() ? "the policy" : "'" + by.person + "'") +
                              (by.reason.empty() ? "" : ": " + by.reason),
                          1024);
  } else if (all_before_skipped(task) || held == nullptr) {
    out.reason = "every task before it was skipped";
  } else {
    const Choice& choice = held->choice;
    out.reason = cut_utf8(verdict_text(tasks()[task].when.front(), choice.node, choice.reading), 1024);
    out.data = to_json(choice.reading);
  }
  return out;
}

}  // namespace trb::scheduler
