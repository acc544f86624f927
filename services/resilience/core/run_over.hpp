// How an alert shows that its run is over.
#pragma once

#include <string>

#include "services/resilience/core/run_watcher.hpp"

namespace trb::resilience {

/// The run is not watched any more.
[[nodiscard]] std::string run_over_text(const RunWatcher& runs, const std::string& run);

}  // namespace trb::resilience
