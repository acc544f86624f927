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
  if (body.code == errc_name(Errc::expired)) give_up_delivery(body, from, step);
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
