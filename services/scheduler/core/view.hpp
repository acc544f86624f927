// A run as a person sees it.
#pragma once

#include "common/base/time.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {

RunState state_of(const Run& run, const Executor& executor, UtcTime now);

/// What a run waits for, in words: when PAUSED or ABORTING, and when this node's next task finds its robot not ready.
std::string waits_for(const Run& run, const Executor& executor, UtcTime now);

/// A view is one message: of a very large run the longest words are left out, then what the oldest decisions were on.
void fit(RunView& view);
RunView view_of(const Run& run, const Executor& executor, UtcTime now);
RunSummary summary_of(const Run& run, const Executor& executor, UtcTime now);

}  // namespace trb::scheduler
