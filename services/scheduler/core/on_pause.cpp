// SchedulerCore: runs that a person holds, and lets go on. What runs is finished; nothing is begun.
#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

void SchedulerCore::handle(const RunPause& body, const Inbound& from, Step step) {
  const auto claimed = decode<PauseOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = run_or_hold(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->check_pause(body.order); !order) return refuse(from, order.error(), step);
  const bool here = from.source == settings_.node;
  const RunState state = state_of(*run, executor_, step.now.utc);
  if (here && state != RunState::running && state != RunState::paused) {
    const std::string what = "run " + run->id() + " is " + std::string(name_of(state));
    return refuse(from, fail(Errc::conflict, what), step);
  }
  if (run->is_newer(*claimed)) {
    const JournalPause fact{body.order, here};
    step.out.record(fact);
    step.out.log(LogLevel::warning, claimed->paused ? "run_held" : "run_goes_on",
                 "run " + run->id() + " by '" + claimed->by + "': " + claimed->reason);
    if (auto applied = run->apply(fact); !applied) return refuse(from, applied.error(), step);
  } else if (here && run->pause()->number >= claimed->number && run->pause_record().payload != body.order.payload) {
    return refuse(from, fail(Errc::conflict, "run " + run->id() + ": a newer order is known", "try again"), step);
  }
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + (claimed->paused ? " is held" : " goes on")});
  } else {
    step.out.information(from.source, PauseJournaled{run->id(), run->pause()->number});
  }
}

void SchedulerCore::handle(const PauseJournaled& body, const Inbound& from, Step step) {
  Run* run = run_for(body.run, from, step);
  if (run == nullptr) return;
  if (run->pause() == nullptr || body.number < run->pause()->number) return step.out.count("late.pause_journaled");
  delivered(*run, DutyKind::pause, from, {}, run->epoch(), step);
}

}  // namespace trb
