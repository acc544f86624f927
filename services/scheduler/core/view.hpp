// A run as a person sees it.
#pragma once

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// PAUSED: some task waits for a decision, or all is held. What does not follow that task goes on meanwhile.
RunState state_of(const Run& run, const Executor& executor, Clock clock);

/// A view is one message: of a very large run the longest words are left out, then what the oldest decisions were on.
void fit(RunView& view);
/// `runs`: all that this node knows of.
RunView view_of(const Run& run, const RunStore& runs, const Executor& executor, Clock clock);
RunSummary summary_of(const Run& run, const RunStore& runs, const Executor& executor, Clock clock);
/// Of a run in the archive.
RunSummary summary_of(const RunView& view);

}  // namespace trb::scheduler
