// What trb says of a run's task: its state, who did it, why it stands as it does.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/run.hpp"
#include "proto/bodies/run_view.hpp"

namespace trb::cli {

/// A date as a table shows it, "-" for 0.
std::string time_or_dash(std::int64_t ns);

/// "9.32 s"
std::string took_text(double s);

/// As the protocol calls it, but for RETRIABLE, which reads as if it were tried again: only its `retries` are, or by a
/// person.
std::string state_word(const TaskView& task);

/// Whose attempt the view shows. `doers`: the results by which it is done; empty: they are not known.
std::string robot_of(const TaskView& task, const std::vector<TaskResult>& doers);

/// Why it stands as it does, in the order of what a person asks first; of a task that was done twice the other
/// attempts.
std::string why_of(const TaskView& task, const std::vector<TaskResult>& doers);

}  // namespace trb::cli
