#include "services/resilience/core/run_over.hpp"

namespace trb::resilience {

std::string run_over_text(const RunWatcher& runs, const std::string& run) {
  if (runs.ended(run) != RunState::expired) return "its run is over";
  return "its run has EXPIRED: trb run show " + run.substr(0, 8) + " has everything";
}

}  // namespace trb::resilience
