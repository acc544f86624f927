// A run that ends soon: its remaining tasks will not begin any more.
#pragma once

#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

/// How long before its end a run with that life raises a warning: a tenth of it, 10 min at most.
[[nodiscard]] Duration warning_time(Duration life);
/// When the warning is due; nothing: the run's end or life is not known. The run is_known().
[[nodiscard]] std::optional<MonotonicTime> end_warning_at(const WatchedRun& run);
/// The problem, if the run ends soon. The run is_known().
[[nodiscard]] std::optional<RunProblem> problem_of_end(const WatchedRun& run, Now now);
/// "its end in 9 min"
[[nodiscard]] std::string wait_for_end(const WatchedRun& run, Now now);

}  // namespace trb::resilience
