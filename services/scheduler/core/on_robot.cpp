// SchedulerCore: what the own node says: its mode-adapter, its router's signatures, and what could not be delivered.
#include <algorithm>

#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

namespace {

Error not_own(const Inbound& from) {
  return fail(Errc::not_permitted, "'" + from.source + "' is another node: only the own one says that");
}

}  // namespace

void SchedulerCore::handle(const AdapterState& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) return refuse(from, not_own(from), step);
  executor_.on(body, step.now, step.out);
}

void SchedulerCore::handle(const ExecutionState& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) return refuse(from, not_own(from), step);
  const auto& attempt = executor_.attempt();
  if (!attempt || attempt->execute.key != body.key) return step.out.count("late.execution_state");
  const Phase before = attempt->phase;
  executor_.on(body, step.now, step.out);
  const Run* run = runs_.find(body.key.run);
  const bool began = before != Phase::running && executor_.attempt()->phase == Phase::running;
  if (began && run != nullptr) tell_progress(*run, body.key, TaskState::running, step);
}

void SchedulerCore::handle(const Outcome& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) return refuse(from, not_own(from), step);
  const bool ended = body.outcome != TaskOutcome::none && body.outcome != TaskOutcome::skipped;
  if (!ended) return refuse(from, fail(Errc::bad_value, "an outcome that is none"), step);
  const auto& attempt = executor_.attempt();
  if (attempt && attempt->execute.key == body.key) return executor_.on(body, step.now, step.out);
  const Run* run = runs_.find(body.key.run);
  const auto task = run == nullptr ? std::nullopt : run->index_of(body.key.task);
  const bool held = task && run->results().holds(*task, body.key, settings_.node);
  if (!held)
    step.out.log(LogLevel::warning, "outcome_of_no_attempt", "task '" + body.key.task + "' of run " + body.key.run);
  step.out.count(held ? "late.outcome" : "refused.outcome.unknown_run");
  // Whether its result is held or no run wants it: the mode-adapter need not tell it again.
  step.out.information(settings_.node, OutcomeJournaled{body.key});
}

void SchedulerCore::handle(const SignedRecord& body, const Inbound& from, Step step) {
  if (from.source != settings_.node) return refuse(from, not_own(from), step);
  const auto& attempt = executor_.attempt();
  const bool asked = attempt && attempt->phase == Phase::signing && body.kind == kSignedResult &&
                     body.payload.bytes == attempt->payload;
  if (!asked) {
    for (Run* run : runs_.runs()) {
      if (keep_signed_choice(*run, body, step) || keep_signed_skip(*run, body, step) ||
          keep_signed_abort(*run, body, step) || keep_signed_hold(*run, body, step) ||
          keep_signed_end(*run, body, step)) {
        return;
      }
    }
    return step.out.count("late.signed_record");
  }
  Run* run = runs_.find(attempt->execute.key.run);
  if (run == nullptr) return refuse(from, fail(Errc::unknown_run, "a signed result of no run"), step);
  auto held = run->check_result(body);
  if (!held) {
    step.out.log(LogLevel::error, "own_signature_wrong", held.error().text());
    return refuse(from, held.error(), step);
  }
  keep_result(*run, std::move(*held), step);
  executor_.done(step.out);
}

void SchedulerCore::handle(const Ack& body, const Inbound& from, Step step) {
  if (from.source == settings_.node && body.state == "out_of_use") lost_.told(step.now, step.out);
}

void SchedulerCore::handle(const Nack& body, const Inbound& from, Step step) {
  step.out.count("nacked." + std::string(is_typed(body.subtype) ? body.subtype : "opaque"));
  if (from.source == settings_.node && body.subtype == Execute::kSubtype) {
    return executor_.on_refusal(body, step.now, step.out);
  }
  if (body.subtype == SensorRead::kSubtype) return refused_reading(body, from, step);
  if (from.source == settings_.node && body.subtype == SignRequest::kSubtype) {
    return step.out.log(LogLevel::error, "not_signed", body.code + ": " + body.what);
  }
  if (body.subtype == Baton::kSubtype && body.code == errc_name(Errc::conflict)) return ask_newer(body, from, step);
  if (body.subtype == Baton::kSubtype && body.code == errc_name(Errc::queue_full)) note_refusal(body, from);
  // For a peer the run is over, and it will never journal what it is owed. Its word alone is not believed.
  Run* run = body.code == errc_name(Errc::expired) ? runs_.find(body.about) : nullptr;
  if (run == nullptr || !(run->expired(step.steady) || run->aborted() || run->ended())) return;
  if (body.subtype == Results::kSubtype) run->deliveries.drop(DeliveryKind::results, from.source);
  if (body.subtype == RunAbort::kSubtype) run->deliveries.drop(DeliveryKind::abort, from.source);
  if (body.subtype == RunDecision::kSubtype) run->deliveries.drop(DeliveryKind::decision, from.source);
  if (body.subtype == RunPause::kSubtype) run->deliveries.drop(DeliveryKind::pause, from.source);
}

void SchedulerCore::note_refusal(const Nack& body, const Inbound& from) {
  Run* run = runs_.find(body.about);
  if (run != nullptr && run->is_member(from.source)) run->refusals[from.source] = body.what;
}

/// Who refuses a baton may be in a later epoch, and the decider gone that would tell of it.
void SchedulerCore::ask_newer(const Nack& body, const Inbound& from, Step step) {
  Run* run = runs_.find(body.about);
  if (run == nullptr) return;
  const std::vector<std::string> owed = run->deliveries.creditors(DeliveryKind::baton);
  if (std::find(owed.begin(), owed.end(), from.source) == owed.end()) return;
  run->asked_decisions.insert(from.source);
  step.out.request(from.source, NeedDefinition{run->id(), run->start().digest});
}

}  // namespace trb
