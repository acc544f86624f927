// A run that ends soon: what is not done then is not begun any more.
#pragma once

#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

/// So long before its end a run of that life raises a warning: a tenth of it, 10 min at most.
[[nodiscard]] Duration warning_time(Duration life);
/// When it is due; nothing: its end or its life is not known. The run is_known().
[[nodiscard]] std::optional<MonotonicTime> end_warning_at(const WatchedRun& run);
/// It ends soon. The run is_known().
[[nodiscard]] std::optional<RunProblem> problem_of_end(const WatchedRun& run, Now now);
/// "its end in 9 min"
[[nodiscard]] std::string wait_for_end(const WatchedRun& run, Now now);

}  // namespace trb::resilience
