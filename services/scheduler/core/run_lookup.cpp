#include "services/scheduler/core/run_lookup.hpp"

#include <algorithm>

#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {
namespace {

/// The order would bring such a message about anew: the two would send them to each other for ever.
bool follows_from_abort(const Body& body) {
  return holds_alternative<RunAbort>(body) || holds_alternative<AbortConfirmed>(body) ||
         holds_alternative<NeedDefinition>(body);
}

}  // namespace

Run* RunLookup::find(const std::string& run, const Inbound& from, Step step) const {
  Run* known = runs_.find(run);
  if (const auto is_over = over(run)) {
    refuse_over(run, *is_over, from, step);
  } else if (known == nullptr) {
    refuse(from, fail(Errc::unknown_run, "run " + run + " is not known on '" + node_ + "'"), step);
  } else if (!known->members().contains(from.source)) {
    refuse(from, fail(Errc::not_permitted, "'" + from.source + "' is no member of run " + run), step);
  } else {
    return known;
  }
  return nullptr;
}

Run* RunLookup::find_or_defer(const std::string& run, const Blob& digest, const Inbound& from, Step step) {
  const bool answer = from.reply_to != 0 || from.source == node_;
  if (answer || runs_.find(run) != nullptr || archive_.over(run)) return find(run, from, step);
  if (runs_.full() || !defer(run, from, step)) {
    refuse(from,
           fail(Errc::queue_full, "no place for run " + run + " on '" + node_ + "'",
                "end some of its " + std::to_string(runs_.taken()) + " open runs: trb run list"),
           step);
  } else {
    step.out.request(from.source, NeedDefinition{run, digest, true, true});
  }
  return nullptr;
}

bool RunLookup::defer(const std::string& run, const Inbound& from, Step step) {
  const auto without_place = deferred_.add(run, from, step.now.mono);
  if (!without_place) return true;
  if (without_place->source == from.source) return false;  // its newest is this one
  refuse(*without_place,
         fail(Errc::queue_full,
              "too many messages of '" + without_place->source + "' wait on '" + node_ + "' for their runs"),
         step);
  return true;
}

bool RunLookup::defer_for_decisions(Run& run, std::uint32_t epoch, const Inbound& from, Step step) {
  if (epoch <= run.epochs().current()) return false;
  // A node that has not sent the decision that its message needs is not asked again.
  const bool can_ask = !handing_out_ && from.reply_to == 0 && from.source != node_;
  if (!can_ask || !defer(run.id(), from, step)) {
    refuse(from,
           fail(Errc::conflict, "run " + run.id() + ": epoch " + std::to_string(epoch) + " is not known here yet"),
           step);
    return true;
  }
  request_decisions(run, from.source, step);
  return true;
}

void RunLookup::request_decisions(Run& run, const std::string& node, Step step) const {
  if (node == node_) return;
  run.work().awaited().await_decisions(node);
  step.out.request(node, NeedDefinition{run.id(), run.definition().start().digest, false, true});
}

std::optional<Over> RunLookup::over(const std::string& run) const {
  return runs_.find(run) == nullptr ? archive_.over(run) : std::nullopt;
}

void RunLookup::refuse_over(const std::string& run, const Over& over, const Inbound& from, Step step) const {
  if (!over.end.kind.empty() && from.source != node_) step.out.information(from.source, RunOver{over.end});
  if (over.state == RunState::aborted) send_archived_abort(run, from, step);
  refuse(from,
         fail(Errc::expired, "run " + run + " is over: " + std::string(name_of(over.state)), "trb run show has it"),
         step);
}

/// A node that was revoked is owed no order. If it is a member again, its journal may hold the run open, and its robot
/// would go on.
void RunLookup::send_archived_abort(const std::string& run, const Inbound& from, Step step) const {
  if (from.source == node_ || follows_from_abort(from.body)) return;
  const auto record = archive_.record(run);
  if (!record) return step.out.count("abort_not_kept");
  const auto abort = std::ranges::find(record->orders, kSignedRunAbort, &SignedRecord::kind);
  if (abort != record->orders.end()) step.out.command(from.source, RunAbort{*abort});
}

void RunLookup::tell_aborted(const Run& run, const Inbound& from, Step step) const {
  if (from.source == node_ || !run.orders().is_aborted()) return;
  if (run.deliveries().pending().owes(DeliveryKind::abort, from.source)) return;
  step.out.command(from.source, RunAbort{run.orders().abort_record()});
}

bool RunLookup::awaits_definition(const std::string& run, const std::string& from) const {
  return deferred_.waits(run, from);
}

bool RunLookup::is_first_passed(const RunStart& start) const {
  return deferred_.any(start.run, start.submitter, is_first_pass);
}

void RunLookup::hand_out(const std::string& run, const Dispatch& dispatch, Step step) {
  // Nothing starts before the step's end: an abort among them comes before any start.
  handing_out_ = true;
  for (const Inbound& message : deferred_.take(run)) dispatch(message, step);
  handing_out_ = false;
}

void RunLookup::refuse_deferred(const std::string& run, const std::string& from, const Error& error, Step step) {
  for (const Inbound& message : deferred_.take(run, from)) refuse(message, error, step);
}

void RunLookup::refuse_late(Step step) {
  for (const Inbound& message : deferred_.take_late(step.now.mono)) {
    refuse(message, fail(Errc::unknown_run, "its run's definition, or its decision, did not come"), step);
  }
}

}  // namespace trb::scheduler
