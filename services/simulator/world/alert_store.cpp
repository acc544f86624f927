#include "services/simulator/world/alert_store.hpp"

#include <algorithm>
#include <any>

namespace trb::world {

void AlertStore::write(const std::vector<Journal>& records) {
  for (const Journal& one : records) {
    if (const auto* alert = std::any_cast<Alert>(&one.record)) {
      alerts_[alert->id] = *alert;
      if (!resilience::is_open(*alert)) decisions_.erase(alert->id);
    } else if (const auto* decision = std::any_cast<RunDecision>(&one.record)) {
      const auto content = decode<Decision>(decision->decision.payload.bytes);
      if (content) decisions_[content->alert] = {decision->decision, false};
    } else if (const auto* over = std::any_cast<resilience::DecisionOver>(&one.record)) {
      end(*over);
    }
  }
  forget_oldest();
}

void AlertStore::end(const resilience::DecisionOver& is) {
  const auto of = std::ranges::find_if(decisions_, [&](const auto& one) {
    const auto content = decode<Decision>(one.second.record.payload.bytes);
    return content && content->run == is.run && content->epoch == is.epoch;
  });
  if (of == decisions_.end()) return;
  if (is.end == resilience::DecisionEnd::dropped) {
    decisions_.erase(of);
  } else {
    of->second.delivered = true;
  }
}

/// Of those that are over it keeps so many.
void AlertStore::forget_oldest() {
  if (alerts_.size() <= resilience::AlertBook::kMaxDone) return;
  std::multimap<std::int64_t, std::string> done;
  for (const auto& [id, alert] : alerts_) {
    if (!resilience::is_open(alert)) done.emplace(alert.time, id);
  }
  while (done.size() > resilience::AlertBook::kMaxDone) {
    alerts_.erase(done.begin()->second);
    done.erase(done.begin());
  }
}

void AlertStore::restore(resilience::ResilienceCore& core) const {
  std::vector<Alert> alerts;
  for (const auto& [id, alert] : alerts_) alerts.push_back(alert);
  std::vector<resilience::StoredDecision> decisions;
  for (const auto& [alert, decision] : decisions_) decisions.push_back(decision);
  core.restore(std::move(alerts), decisions);
}

}  // namespace trb::world
