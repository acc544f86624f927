// SchedulerCore: the end of a run by order.
#include "proto/value.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::handle(const RunAbort& body, const Inbound& from, Step step) {
  const auto claimed = decode<AbortOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  const bool here = from.source == settings_.node;
  const auto over = runs_.find(claimed->run) == nullptr ? archive_.over(claimed->run) : std::nullopt;
  if (over && over->state == RunState::aborted && !here) {
    return step.out.information(from.source, AbortConfirmed{claimed->run});
  }
  Run* run = run_or_defer(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->check_abort(body.order); !order) return refuse(from, order.error(), step);
  const RunState state = state_of(*run, executor_, step.clock());
  if (here && (state == RunState::finished || state == RunState::expired)) {
    const Errc code = state == RunState::finished ? Errc::conflict : Errc::expired;
    return refuse(from, fail(code, "run " + run->id() + " is " + std::string(name_of(state))), step);
  }
  // Everything is done: there is nothing to end.
  if (run->ended()) return refuse_over(run->id(), {RunState::finished, *run->end()}, from, step);
  if (auto kept = keep_abort(*run, body.order, here, step); !kept) return refuse(from, kept.error(), step);
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + " is being aborted"});
  } else {
    run->confirm_to.insert(from.source);
  }
}

Status SchedulerCore::keep_abort(Run& run, const SignedRecord& order, bool here, Step step) {
  if (run.aborted()) return Done{};
  const JournalAbort fact{order, here};
  if (auto applied = run.apply(fact); !applied) return applied;
  step.out.record(fact);
  const auto is = decode<AbortOrder>(order.payload.bytes);
  step.out.log(LogLevel::warning, "run_aborted", "run " + run.id() + " by '" + is->by + "': " + is->reason);
  return Done{};
}

Status SchedulerCore::take_orders(Run& run, const std::vector<SignedRecord>& orders, Step step) {
  const auto check = [&](const SignedRecord& order) -> Status {
    if (order.kind == kSignedRunAbort) {
      const auto abort = run.check_abort(order);
      return abort ? Status(Done{}) : abort.error();
    }
    const auto pause = run.check_pause(order);
    return pause ? Status(Done{}) : pause.error();
  };
  for (const SignedRecord& order : orders) {
    if (auto good = check(order); !good) return good;
  }
  if (run.ended()) return Done{};
  for (const SignedRecord& order : orders) {
    const bool aborts = order.kind == kSignedRunAbort;
    if (auto kept = aborts ? keep_abort(run, order, false, step) : keep_pause(run, order, false, step); !kept) {
      return kept;
    }
  }
  return Done{};
}

/// A task whose failure ends the run: the order is this node's, as if a person had given it here.
void SchedulerCore::abort_on_failure(Run& run, Step step) {
  if (run.aborted() || run.ended() || run.expired(step.steady)) return;
  if (const auto task = run.ending_task(); task && !run.abort_signature) {
    const TaskResult& result = run.current(*task)->result;
    const std::string why = "task '" + run.tasks()[*task].id + "' " + std::string(name_of(result.outcome)) + " on '" +
                            result.robot + "': " + result.reason;
    const AbortOrder order{run.id(), settings_.node, cut_utf8(why, 255), step.now.utc.ns};
    run.abort_signature = Signature{std::string(kSignedRunAbort), encode(order), step.now.mono};
  }
  if (run.abort_signature) run.abort_signature->tick(settings_.node, step.now, step.out);
}

bool SchedulerCore::keep_signed_abort(Run& run, const SignedRecord& record, Step step) {
  if (!run.abort_signature || !run.abort_signature->asks_for(record)) return false;
  if (auto order = run.check_abort(record); !order) return wrong_signature(order.error(), step);
  if (auto kept = keep_abort(run, record, true, step); !kept) return wrong_signature(kept.error(), step);
  return true;
}

void SchedulerCore::confirm_abort(Run& run, Step step) {
  if (!run.aborted() || executor_.runs(run.id())) return;
  for (const std::string& member : run.confirm_to) step.out.information(member, AbortConfirmed{run.id()});
  run.confirm_to.clear();
}

void SchedulerCore::handle(const AbortConfirmed& body, const Inbound& from, Step step) {
  if (Run* run = run_for(body.run, from, step)) delivered(*run, DeliveryKind::abort, from, {}, run->epoch(), step);
}

}  // namespace trb
