// SchedulerCore: runs that a person holds, and lets go on. What runs is finished; nothing is begun.
#include <algorithm>

#include "proto/value.hpp"
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::handle(const RunPause& body, const Inbound& from, Step step) {
  const auto claimed = decode<PauseOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = run_or_defer(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->check_pause(body.order); !order) return refuse(from, order.error(), step);
  const bool here = from.source == settings_.node;
  const RunState state = state_of(*run, executor_, step.clock());
  if (here && state != RunState::running && state != RunState::paused) {
    const std::string what = "run " + run->id() + " is " + std::string(name_of(state));
    return refuse(from, fail(Errc::conflict, what), step);
  }
  if (run->ended()) return refuse_over(run->id(), {RunState::finished, *run->end()}, from, step);
  if (here && !claimed->paused && !run->names_doubles(*claimed)) {
    return refuse(from,
                  fail(Errc::conflict,
                       "run " + run->id() + ": task '" + run->pause()->doubles.front() +
                           "' was done twice, and the order does not say that somebody has looked",
                       "look at the robots, then say it on node '" + run->judge() + "'"),
                  step);
  }
  if (auto kept = keep_pause(*run, body.order, here, step); !kept) return refuse(from, kept.error(), step);
  if (here && run->pause()->number >= claimed->number && run->pause_record().payload != body.order.payload) {
    return refuse(from, fail(Errc::conflict, "run " + run->id() + ": a newer order is known", "try again"), step);
  }
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + (claimed->paused ? " is held" : " goes on")});
  } else {
    step.out.information(from.source, PauseJournaled{run->id(), run->pause()->number});
    // Who tells of the order that counts has it.
    if (claimed->number == run->pause()->number && run->deliveries.owes(DeliveryKind::pause, from.source)) {
      delivered(*run, DeliveryKind::pause, from, {}, run->epoch(), step);
    }
  }
}

Status SchedulerCore::keep_pause(Run& run, const SignedRecord& order, bool here, Step step) {
  const auto is = run.check_pause(order);
  if (!is) return is.error();
  run.outbid(*is);
  if (!run.is_newer(*is)) return Done{};
  const JournalPause fact{order, here};
  if (auto applied = run.apply(fact); !applied) return applied;
  step.out.record(fact);
  step.out.log(LogLevel::warning, is->paused ? "run_held" : "run_goes_on",
               "run " + run.id() + " by '" + is->by + "': " + is->reason);
  return Done{};
}

/// A task that was done twice holds the run everywhere until a person has looked: the judge orders it.
void SchedulerCore::hold_for_doubles(Run& run, Step step) {
  const bool open = !run.aborted() && !run.ended() && !run.expired(step.steady);
  const bool wanted = run.has_new_double() || run.is_outbid();
  if (run.judge() != settings_.node || !open || !wanted) return run.hold_signature.reset();
  if (!run.hold_signature) {
    const std::vector<std::string>& doubles = run.doubles();
    const std::string why = "task '" + doubles.front() + "' has two different results (double_execution)";
    const PauseOrder order{run.id(),           run.next_hold(), true,   settings_.node,
                           cut_utf8(why, 255), step.now.utc.ns, doubles};
    run.hold_signature = Signature{std::string(kSignedRunPause), encode(order), step.now.mono};
  }
  run.hold_signature->tick(settings_.node, step.now, step.out);
}

bool SchedulerCore::keep_signed_hold(Run& run, const SignedRecord& record, Step step) {
  if (!run.hold_signature || !run.hold_signature->asks_for(record)) return false;
  if (auto kept = keep_pause(run, record, true, step); !kept) return wrong_signature(kept.error(), step);
  run.hold_signature.reset();
  return true;
}

void SchedulerCore::handle(const PauseJournaled& body, const Inbound& from, Step step) {
  Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (run->pause() == nullptr || body.number < run->pause()->number) return step.out.count("late.pause_journaled");
  delivered(*run, DeliveryKind::pause, from, {}, run->epoch(), step);
}

}  // namespace trb
