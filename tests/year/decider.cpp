#include "tests/year/decider.hpp"

#include <algorithm>

namespace trb::year {

using resilience::ResilienceCore;

Decider::Decider(scheduler::test::Fleet& fleet, ResilienceSettings settings) : fleet_(fleet), settings_(settings) {}

void Decider::start() {
  core_ = std::make_unique<ResilienceCore>(resilience::CoreSettings{"cloud", Role::cloud, settings_, {}});
  store_.restore(*core_);
  fleet_.attach("cloud", *core_,
                {.store = [this](const std::vector<Journal>& records) { store(records); },
                 .after_sends = [this] { core_->fleet().written(); }});
}

void Decider::store(const std::vector<Journal>& records) {
  store_.write(records);
  most_alerts = std::max(most_alerts, store_.alerts().size());
}

void Decider::tell(Body word) {
  if (const auto& process = fleet_["cloud"].guest)
    process->take({MessageType::information, "cloud", "cloud", 1, 0, 0, 1000, std::move(word)});
}

Body Decider::ask(Body question) {
  constexpr std::uint64_t kAsked = 7;
  Body answer;
  const auto& process = fleet_["cloud"].guest;
  if (!process) return answer;
  const Inbound message{MessageType::command, "cloud", "cloud", kAsked, 0, 0, 1000, std::move(question)};
  process->step([&](Now now, Outbox& out) {
    core_->on(message, now, out);
    std::erase_if(out.sends, [&](const Send& send) {
      if (send.reply_to == kAsked) answer = send.body;
      return send.reply_to == kAsked;
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
