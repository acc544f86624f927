#include "services/scheduler/core/handlers/pause_handler.hpp"

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/run/drafts.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr auto kHold = PendingSignatures::RunRecord::hold;

}  // namespace

Status PauseHandler::check_state(const Run& run, Step step) const {
  const RunState state = state_of(run, executor_, step.clock());
  if (state == RunState::running || state == RunState::paused) return Done{};
  return fail(Errc::conflict, "run " + run.id() + " is " + std::string(name_of(state)));
}

Status PauseHandler::check_doubles(const Run& run, const PauseOrder& order) {
  if (order.paused || run.orders().names_doubles(order)) return Done{};
  return fail(Errc::conflict,
              "run " + run.id() + ": task '" + run.orders().pause()->doubles.front() +
                  "' was done twice, and the order does not say that somebody has looked",
              "look at the robots, then say it on node '" + run.definition().rule().judge() + "'");
}

void PauseHandler::handle(const RunPause& body, const Inbound& from, Step step) {
  const auto claimed = decode<PauseOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  Run* run = lookup_.find_or_defer(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->checks().received_pause(body.order); !order) return refuse(from, order.error(), step);
  const bool here = from.source == node_;
  const Status open = here ? check_state(*run, step) : Done{};
  if (!open) return refuse(from, open.error(), step);
  if (run->orders().has_ended()) {
    return lookup_.refuse_over(run->id(), {RunState::finished, run->orders().end_record()}, from, step);
  }
  const Status looked = here ? check_doubles(*run, *claimed) : Done{};
  if (!looked) return refuse(from, looked.error(), step);
  if (auto kept = journal_.keep_pause(*run, body.order, here, step); !kept) return refuse(from, kept.error(), step);
  if (!here) return confirm(*run, *claimed, from, step);
  if (run->orders().pause()->number >= claimed->number && run->orders().pause_record().payload != body.order.payload) {
    return refuse(from, fail(Errc::conflict, "run " + run->id() + ": a newer order is known", "try again"), step);
  }
  step.out.reply(from, Ack{"accepted", "run " + run->id() + (claimed->paused ? " is held" : " goes on")});
}

void PauseHandler::confirm(Run& run, const PauseOrder& order, const Inbound& from, Step step) {
  const std::uint32_t known = run.orders().pause()->number;
  step.out.information(from.source, PauseJournaled{run.id(), known});
  // The sender of the valid order already has it.
  if (order.number == known && run.deliveries().pending().owes(DeliveryKind::pause, from.source)) {
    journal_.keep_delivery(run, DeliveryKind::pause, from, {}, run.epochs().current(), step);
  }
}

void PauseHandler::handle(const PauseJournaled& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  const PauseOrder* known = run->orders().pause();
  if (known == nullptr || body.number < known->number) return step.out.count("late.pause_journaled");
  journal_.keep_delivery(*run, DeliveryKind::pause, from, {}, run->epochs().current(), step);
}

void PauseHandler::hold_for_doubles(Run& run, Step step) const {
  PendingSignatures& signatures = run.work().signatures();
  const bool wanted = run.orders().has_new_double() || run.orders().is_outbid();
  if (!run.epochs().judges_here() || !run.is_open(step.steady) || !wanted) return signatures.drop(kHold);
  if (!signatures.wants(kHold)) {
    signatures.want(kHold, {kSignedRunPause, encode(hold_order(run, step.now.utc)), step.now});
  }
  signatures.tick(kHold, node_, step.now, step.out);
}

bool PauseHandler::keep_signed(Run& run, const SignedRecord& record, Step step) {
  if (!run.work().signatures().is_for(kHold, record)) return false;
  if (auto kept = journal_.keep_pause(run, record, true, step); !kept) {
    log_wrong_signature(kept.error(), step);
  } else {
    run.work().signatures().drop(kHold);
  }
  return true;
}

}  // namespace trb::scheduler
