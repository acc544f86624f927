#include "services/cloud-gateway/core/live/fleet_questions.hpp"

#include <algorithm>

namespace trb::gateway {

void FleetQuestions::on_welcome(std::string node, Now now) {
  node_ = std::move(node);
  routes_at_ = runs_at_ = alerts_at_ = now.mono;
  for (auto& [run, asked] : runs_) asked = {now.mono};
}

void FleetQuestions::want_routes(Now now) {
  routes_at_ = std::min(routes_at_, now.mono + kSoon);
}

void FleetQuestions::want_run(const std::string& run, Now now) {
  if (runs_.size() < kMaxRuns) runs_.emplace(run, AskedRun{now.mono});
}

void FleetQuestions::tick(Now now, Outbox& out) {
  if (node_.empty()) return;
  const auto ask = [&](MonotonicTime& at, Duration every, Body body) {
    if (now.mono < at) return;
    at = now.mono + every;
    out.request(node_, std::move(body));
  };
  ask(routes_at_, kRoutes, RouteListRequest{});
  ask(runs_at_, kRuns, RunWatch{kRunLease_s});
  ask(alerts_at_, kAlerts, AlertListRequest{.all = true});
  ask_runs(now, out);
}

void FleetQuestions::ask_runs(Now now, Outbox& out) {
  for (auto at = runs_.begin(); at != runs_.end();) {
    if (now.mono < at->second.at) {
      ++at;
    } else if (at->second.tries == kTries) {
      given_up_.push_back(at->first);
      at = runs_.erase(at);
    } else {
      ++at->second.tries;
      at->second.at = now.mono + kRunAgain;
      out.request(node_, RunQuery{at->first});
      ++at;
    }
  }
}

std::optional<MonotonicTime> FleetQuestions::next_deadline() const {
  if (node_.empty()) return std::nullopt;
  MonotonicTime out = std::min({routes_at_, runs_at_, alerts_at_});
  for (const auto& [run, asked] : runs_) out = std::min(out, asked.at);
  return out;
}

}  // namespace trb::gateway
