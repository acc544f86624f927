// Scenarios that several tests run.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/run.hpp"

namespace trb::scheduler::test {

/// A test's run, where it has one.
inline const std::string kRun(32, 'a');

/// The paper's scenario of section 6.1 after its re-assignment: nine tasks, a fork and a join for five robots.
Scenario nine_tasks();
/// A chain of tasks "task-0", "task-1" …
Scenario chain(const std::vector<std::string>& robots);

}  // namespace trb::scheduler::test
