#include "services/resilience/core/run_over.hpp"

#include "proto/value.hpp"

namespace trb::resilience {

std::string run_over_text(const RunWatcher& runs, const std::string& run) {
  if (runs.ended(run) != RunState::expired) return "its run is over";
  return "its run has EXPIRED: trb run show " + run.substr(0, 8) + " has everything";
}

std::string recovery_text(const WatchedRun& run) {
  constexpr std::size_t kMost = 512;
  const std::string& waits = run.summary.waits_for;
  return cut_utf8(
      "its run, of which this node may have lost what was decided" + (waits.empty() ? "" : ": it waits for " + waits),
      kMost);
}

}  // namespace trb::resilience
