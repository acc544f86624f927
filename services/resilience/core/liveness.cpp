#include "services/resilience/core/liveness.hpp"

#include "services/resilience/core/alert_causes.hpp"

namespace trb::resilience {

void Liveness::look(const std::string& id, const RobotRecord* robot, Now now, bool expired) {
  if (!begun_) return;
  const bool reached = robot != nullptr && robot->reached;
  if (reached && robot->profile.is.robot == "ONLINE") {
    away_.erase(id);
    return;
  }
  const auto [at, is_new] = away_.try_emplace(id);
  Gone& gone = at->second;
  if (is_new) gone.since = now.mono;
  if (expired) gone.since = now.mono - kGrace;
  gone.cause = reached ? kRobotLost : kNodeLost;
  gone.text = robot == nullptr ? "its node is not known" : why_unfit(*robot);
}

const Liveness::Gone* Liveness::find(std::string_view id, Now now) const {
  const auto at = away_.find(id);
  if (at == away_.end() || now.mono - at->second.since < kGrace) return nullptr;
  return &at->second;
}

std::optional<MonotonicTime> Liveness::next(std::string_view id, Now now) const {
  const auto at = away_.find(id);
  if (at == away_.end() || at->second.since + kGrace <= now.mono) return std::nullopt;
  return at->second.since + kGrace;
}

std::optional<MonotonicTime> Liveness::next(Now now) const {
  std::optional<MonotonicTime> out;
  for (const auto& [id, gone] : away_) {
    if (gone.since + kGrace > now.mono) out = earlier(out, gone.since + kGrace);
  }
  return out;
}

}  // namespace trb::resilience
