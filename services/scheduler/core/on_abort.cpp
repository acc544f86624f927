// SchedulerCore: the end of a run by order.
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::handle(const RunAbort& body, const Inbound& from, Step step) {
  const auto claimed = decode<AbortOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = run_or_hold(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->check_abort(body.order); !order) return refuse(from, order.error(), step);
  const bool here = from.source == settings_.node;
  const RunState state = state_of(*run, executor_, step.now.utc);
  if (here && (state == RunState::finished || state == RunState::expired)) {
    const Errc code = state == RunState::finished ? Errc::conflict : Errc::expired;
    return refuse(from, fail(code, "run " + run->id() + " is " + std::string(name_of(state))), step);
  }
  if (!run->aborted() || (here && !run->abort_ordered_here())) {
    const JournalAbort fact{body.order, here};
    step.out.record(fact);
    step.out.log(LogLevel::warning, "run_aborted",
                 "run " + run->id() + " by '" + claimed->by + "': " + claimed->reason);
    if (auto applied = run->apply(fact); !applied) return refuse(from, applied.error(), step);
  }
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + " is being aborted"});
  } else {
    run->confirm_to.insert(from.source);
  }
}

/// A task whose failure ends the run: the order is this node's, as if a person had given it here.
void SchedulerCore::abort_on_failure(Run& run, Step step) {
  if (!run.aborts_on_failure() || run.aborted() || run.expired(step.now.utc)) return;
  for (const TaskIndex task : run.troubles()) {
    const HeldResult& held = *run.results().of(task);
    const bool ends = run.tasks()[task].on_failure == OnFailure::abort && held.result.robot == settings_.node &&
                      held.result.outcome == TaskOutcome::failed;
    if (!ends || run.abort_signature) continue;
    const std::string why = "task '" + run.tasks()[task].id + "' failed: " + held.result.reason;
    const AbortOrder order{run.id(), settings_.node, why.substr(0, 255), step.now.utc.ns};
    run.abort_signature = Signature{std::string(kSignedRunAbort), encode(order), step.now.mono};
  }
  if (run.abort_signature) run.abort_signature->tick(settings_.node, step.now, step.out);
}

bool SchedulerCore::keep_signed_abort(Run& run, const SignedRecord& record, Step step) {
  if (!run.abort_signature || !run.abort_signature->asks_for(record)) return false;
  if (auto order = run.check_abort(record); !order) return wrong_signature(order.error(), step);
  const JournalAbort fact{record, true};
  step.out.record(fact);
  step.out.log(LogLevel::warning, "run_aborted", "run " + run.id() + ": a task's failure ends it");
  if (auto applied = run.apply(fact); !applied) return wrong_signature(applied.error(), step);
  return true;
}

void SchedulerCore::confirm_abort(Run& run, Step step) {
  if (!run.aborted() || executor_.runs(run.id())) return;
  for (const std::string& member : run.confirm_to) step.out.information(member, AbortConfirmed{run.id()});
  run.confirm_to.clear();
}

void SchedulerCore::handle(const AbortConfirmed& body, const Inbound& from, Step step) {
  if (Run* run = run_for(body.run, from, step)) delivered(*run, DutyKind::abort, from, {}, run->epoch(), step);
}

}  // namespace trb
