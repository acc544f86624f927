#include "tests/year/decider.hpp"

namespace trb::year {

using resilience::ResilienceCore;

Decider::Decider(scheduler::test::Fleet& fleet, ResilienceSettings settings) : fleet_(fleet), settings_(settings) {}

void Decider::start() {
  core_ = std::make_unique<ResilienceCore>(resilience::CoreSettings{"cloud", Role::cloud, settings_, {}});
  std::vector<Alert> alerts;
  for (const auto& [id, alert] : alerts_) alerts.push_back(alert);
  std::vector<resilience::StoredDecision> decisions;
  for (const auto& [alert, decision] : decisions_) decisions.push_back(decision);
  core_->restore(std::move(alerts), decisions);
  fleet_.nudge("cloud", [&](auto&, Now now, Outbox& out) {
    core_->on_welcome({"cloud", Role::cloud, 1}, now, out);
    keep(out);
  });
}

/// As the database does: the newest version of each alert, 200 that are over, a decision until it is delivered.
void Decider::keep(const Outbox& out) {
  bool is_one_over = false;
  for (const Journal& one : out.journal) {
    if (const auto* alert = std::any_cast<Alert>(&one.record)) {
      alerts_[alert->id] = *alert;
      if (resilience::is_open(*alert)) continue;
      decisions_.erase(alert->id);
      is_one_over = true;
    } else if (const auto* decision = std::any_cast<RunDecision>(&one.record)) {
      decisions_[decode<Decision>(decision->decision.payload.bytes)->alert] = {decision->decision, false};
    }
  }
  core_->fleet().written();
  if (is_one_over) forget_old();
  most_alerts = std::max(most_alerts, alerts_.size());
}

void Decider::forget_old() {
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

void Decider::on(const Inbound& message, Now now, Outbox& out) {
  core_->on(message, now, out);
  keep(out);
}

void Decider::tick(Now now, Outbox& out) {
  core_->tick(now, out);
  keep(out);
}

std::optional<MonotonicTime> Decider::next_deadline() const {
  return core_ ? core_->next_deadline() : std::nullopt;
}

void Decider::tell(Body word) {
  fleet_.nudge("cloud", [&](auto&, Now now, Outbox& out) {
    on({MessageType::information, "cloud", "cloud", 1, 0, 0, 1000, word}, now, out);
  });
}

Body Decider::ask(Body question) {
  constexpr std::uint64_t kAsked = 7;
  Body answer;
  fleet_.nudge("cloud", [&](auto&, Now now, Outbox& out) {
    on({MessageType::command, "cloud", "cloud", kAsked, 0, 0, 1000, question}, now, out);
    std::erase_if(out.sends, [&](const Send& send) {
      if (send.reply_to != kAsked) return false;
      answer = send.body;
      return true;
    });
  });
  return answer;
}

std::vector<Alert> Decider::alerts() {
  const Body answer = ask(AlertListRequest{false});
  const auto* table = get_if<AlertTable>(&answer);
  if (table == nullptr) return {};
  std::vector<Alert> out = table->alerts;
  std::erase_if(out, [](const Alert& alert) { return alert.id.empty(); });
  return out;
}

Body Decider::decide(const AlertDecide& verdict) {
  return ask(verdict);
}

}  // namespace trb::year
