// How an alert shows that its run is over, or that nobody can decide on it yet.
#pragma once

#include <string>

#include "services/resilience/core/run_watcher.hpp"

namespace trb::resilience {

/// The run is not watched any more.
[[nodiscard]] std::string run_over_text(const RunWatcher& runs, const std::string& run);
/// It WatchedRun::recovers().
[[nodiscard]] std::string recovery_text(const WatchedRun& run);

}  // namespace trb::resilience
