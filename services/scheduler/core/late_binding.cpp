#include "services/scheduler/core/late_binding.hpp"

#include <algorithm>
#include <cstdio>

namespace trb::scheduler {
namespace {

/// When it is too late; nothing: it may wait for ever.
std::optional<MonotonicTime> too_late_at(const Run& run, TaskIndex task, MonotonicTime since) {
  constexpr double kLongest_s = 1e8;
  const double within_s = run.tasks()[task].start_within_s;
  if (within_s <= 0) return std::nullopt;
  return since + seconds(std::min(within_s, kLongest_s));
}

}  // namespace

std::string within_text(const Run& run, TaskIndex task) {
  char within[32];
  std::snprintf(within, sizeof within, "%g s", run.tasks()[task].start_within_s);
  return within;
}

std::string unbound_late_text(const Run& run, TaskIndex task) {
  return "it did not begin within " + within_text(run, task) + ": no robot was chosen";
}

std::vector<TaskIndex> unbound_too_long(const Run& run, Clock clock) {
  std::vector<TaskIndex> out;
  if (!run.may_start(clock.steady)) return out;
  for (const auto& [task, since] : run.work().timers().unbound_since()) {
    const auto at = too_late_at(run, task, since);
    // What a fact of this step has changed, the timers follow from the next step on.
    if (at && *at <= clock.mono && run.facts().wants_robot(task)) out.push_back(task);
  }
  return out;
}

std::optional<MonotonicTime> next_unbound_too_long(const Run& run, MonotonicTime now) {
  std::optional<MonotonicTime> out;
  for (const auto& [task, since] : run.work().timers().unbound_since()) {
    const auto at = too_late_at(run, task, since);
    if (at && *at > now) out = earlier(out, at);
  }
  return out;
}

}  // namespace trb::scheduler
