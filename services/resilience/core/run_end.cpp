#include "services/resilience/core/run_end.hpp"

#include <algorithm>

namespace trb::resilience {
namespace {

std::string time_text(Duration left) {
  const auto s = std::max<std::int64_t>(0, left / std::chrono::seconds(1));
  return s >= 90 ? std::to_string((s + 30) / 60) + " min" : std::to_string(s) + " s";
}

}  // namespace

Duration warning_time(Duration life) {
  return std::min<Duration>(life / 10, std::chrono::minutes(10));
}

std::optional<MonotonicTime> end_warning_at(const WatchedRun& run) {
  const Duration life{run.start->expires - run.start->created};
  if (!run.ends_at || life <= Duration{0}) return std::nullopt;
  return *run.ends_at - warning_time(life);
}

std::optional<RunProblem> problem_of_end(const WatchedRun& run, Now now) {
  const auto warn_at = end_warning_at(run);
  if (!warn_at || *warn_at > now.mono) return std::nullopt;
  const Duration left = *run.ends_at - now.mono;
  RunProblem out;
  out.cause = kRunEnds;
  out.severity = Severity::warning;
  out.text = "run " + run.view->name + " ends in " + time_text(left) + ", at " + to_iso8601(now.utc + left) +
             ": what is not done then is not begun any more";
  return out;
}

std::string wait_for_end(const WatchedRun& run, Now now) {
  return run.ends_at ? "its end in " + time_text(*run.ends_at - now.mono) : "its end";
}

}  // namespace trb::resilience
