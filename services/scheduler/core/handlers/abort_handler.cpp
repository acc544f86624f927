#include "services/scheduler/core/handlers/abort_handler.hpp"

#include "common/base/errc.hpp"
#include "services/scheduler/core/late_binding.hpp"
#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/run/drafts.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr auto kAbort = PendingSignatures::RunRecord::abort;

/// What a task's failure orders; a task that got no robot in time has failed, too.
std::optional<AbortOrder> order_by_failure(const Run& run, Step step) {
  if (const auto task = run.facts().ending_task()) return abort_order(run, *task, step.now.utc);
  for (const TaskIndex task : unbound_too_long(run, step.clock())) {
    if (run.tasks()[task].on_failure == OnFailure::abort)
      return abort_order(run, task, unbound_late_text(run, task), step.now.utc);
  }
  return std::nullopt;
}

/// A person gets a refusal; a member that still passes an order on gets a confirmation.
Status check_not_over(const Run& run, RunState state) {
  if (state != RunState::finished && state != RunState::expired) return Done{};
  const Errc code = state == RunState::finished ? Errc::conflict : Errc::expired;
  return fail(code, "run " + run.id() + " is " + std::string(name_of(state)));
}

}  // namespace

void AbortHandler::handle(const RunAbort& body, const Inbound& from, Step step) {
  const auto claimed = decode<AbortOrder>(body.order.payload.bytes);
  if (!claimed) return refuse(from, claimed.error(), step);
  const bool here = from.source == node_;
  const auto over = lookup_.over(claimed->run);
  if (over && over->state == RunState::aborted && !here) {
    return step.out.information(from.source, AbortConfirmed{claimed->run});
  }
  Run* run = lookup_.find_or_defer(claimed->run, {}, from, step);
  if (run == nullptr) return;
  if (auto order = run->checks().abort(body.order); !order) return refuse(from, order.error(), step);
  const Status open = here ? check_not_over(*run, state_of(*run, executor_, step.clock())) : Done{};
  if (!open) return refuse(from, open.error(), step);
  // Everything is done: nothing is left to abort.
  if (run->orders().has_ended()) {
    return lookup_.refuse_over(run->id(), {RunState::finished, run->orders().end_record()}, from, step);
  }
  if (auto kept = journal_.keep_abort(*run, body.order, here, step); !kept) return refuse(from, kept.error(), step);
  if (here) {
    step.out.reply(from, Ack{"accepted", "run " + run->id() + " is being aborted"});
  } else {
    run->work().note_abort_from(from.source);
  }
}

void AbortHandler::handle(const AbortConfirmed& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  journal_.keep_delivery(*run, DeliveryKind::abort, from, {}, run->epochs().current(), step);
}

void AbortHandler::handle(const PeerExpired& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  if (body.reason.starts_with(errc_name(Errc::cert_revoked)) && revoked_.insert(body.id).second) runs_.touch_all();
}

void AbortHandler::handle(const PeerJoined& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  if (revoked_.erase(body.id) + listed_.erase(body.id) == 0) return;
  // Its journal may still hold open what it was not told of.
  for (Run* run : runs_.touch_all()) {
    const bool owed = run->orders().is_aborted() && run->members().contains(body.id);
    if (owed) run->deliveries().pending().owe(DeliveryKind::abort, body.id, {});
  }
}

void AbortHandler::handle(const RevokedNodes& body, const Inbound& from, Step step) {
  if (from.source != node_) return refuse(from, not_own(from), step);
  listed_.clear();
  for (const RevokedNode& one : body.nodes) listed_[one.id] = one.serial;
  runs_.touch_all();
}

/// A node that was revoked once may be a member by a newer certificate: then the run has that one.
bool AbortHandler::is_revoked(const Run& run, const std::string& member) const {
  if (revoked_.contains(member)) return true;
  const auto listed = listed_.find(member);
  return listed != listed_.end() && run.members().find(member)->serial <= listed->second;
}

void AbortHandler::give_up_revoked(Run& run, Step step) {
  if (!run.orders().is_aborted() && !run.is_recovering()) return;
  for (const std::string& member : run.members().ids()) {
    if (!is_revoked(run, member)) continue;
    run.orders().is_aborted() ? journal_.give_up(run, member, step) : journal_.keep_told(run, member, step);
  }
}

void AbortHandler::confirm(Run& run, Step step) const {
  if (!run.orders().is_aborted() || executor_.runs(run.id())) return;
  for (const std::string& member : run.work().take_unconfirmed()) {
    if (run.deliveries().pending().owes(DeliveryKind::results, member)) {
      run.work().note_abort_from(member);  // once it archives the run it takes no result of it any more
    } else {
      step.out.information(member, AbortConfirmed{run.id()});
    }
  }
}

void AbortHandler::order_on_failure(Run& run, Step step) const {
  PendingSignatures& signatures = run.work().signatures();
  if (!run.is_open(step.steady) || run.is_recovering()) return signatures.drop(kAbort);
  const auto order = order_by_failure(run, step);
  if (!order) return signatures.drop(kAbort);  // a robot was chosen meanwhile, or a person holds the run
  if (!signatures.wants(kAbort)) signatures.want(kAbort, {kSignedRunAbort, encode(*order), step.now});
  signatures.tick(kAbort, node_, step.now, step.out);
}

bool AbortHandler::keep_signed(Run& run, const SignedRecord& record, Step step) {
  if (!run.work().signatures().is_for(kAbort, record)) return false;
  if (auto kept = journal_.keep_abort(run, record, true, step); !kept) log_wrong_signature(kept.error(), step);
  return true;
}

}  // namespace trb::scheduler
