#include "services/scheduler/core/handlers/refusal_handler.hpp"

#include "common/base/errc.hpp"

namespace trb::scheduler {
namespace {

/// What a refused command was to deliver. Batons are not given up: a node without room for a run gets it later.
std::optional<DeliveryKind> delivery_of(const std::string& subtype) {
  if (subtype == Results::kSubtype) return DeliveryKind::results;
  if (subtype == RunAbort::kSubtype) return DeliveryKind::abort;
  if (subtype == RunDecision::kSubtype) return DeliveryKind::decision;
  if (subtype == RunPause::kSubtype) return DeliveryKind::pause;
  return std::nullopt;
}

}  // namespace

void RefusalHandler::handle(const Nack& body, const Inbound& from, Step step) {
  step.out.count("nacked." + std::string(is_typed(body.subtype) ? body.subtype : "opaque"));
  const bool own = from.source == node_;
  if (own && body.subtype == Execute::kSubtype) return executor_.on_refusal(body, step.now, step.out);
  if (body.subtype == SensorRead::kSubtype) return conditions_.on_refusal(body, from, step);
  if (own && body.subtype == SignRequest::kSubtype) {
    return step.out.log(LogLevel::error, "not_signed", body.code + ": " + body.what);
  }
  if (body.subtype == Baton::kSubtype) return batons_.on_refusal(body, from, step);
  note_recovery(body, from, step);
  if (body.code == errc_name(Errc::expired)) give_up_delivery(body, from, step);
}

/// A member that was asked for all that it holds of a run has never heard of it; or the run is over there. Then its end
/// comes with this, and an order to abort it with each refusal of a question for results; unless its record has made
/// room in the archive.
void RefusalHandler::note_recovery(const Nack& nack, const Inbound& from, Step step) const {
  const bool asked = nack.subtype == NeedDefinition::kSubtype || nack.subtype == NeedResults::kSubtype;
  Run* run = asked ? runs_.find(nack.about) : nullptr;
  if (run == nullptr || !run->is_recovering() || !run->members().contains(from.source)) return;
  if (nack.code == errc_name(Errc::unknown_run)) journal_.keep_told(*run, from.source, step);
  if (nack.code != errc_name(Errc::expired)) return;
  if (nack.subtype == NeedDefinition::kSubtype) return run->recovery().note_decisions(from.source);
  if (!run->recovery().note_over(from.source)) return;
  step.out.log(LogLevel::warning, "run_not_kept",
               "run " + run->id() + " is over at '" + from.source + "', which has no proof of it any more");
  journal_.keep_told(*run, from.source, step);
}

/// The peer refuses because the run is over for it: it will never journal what it is owed. Its claim alone is not
/// trusted.
void RefusalHandler::give_up_delivery(const Nack& nack, const Inbound& from, Step step) const {
  Run* run = runs_.find(nack.about);
  const auto kind = delivery_of(nack.subtype);
  if (run == nullptr || !kind || run->is_open(step.steady)) return;
  run->deliveries().pending().drop(*kind, from.source);
}

}  // namespace trb::scheduler
