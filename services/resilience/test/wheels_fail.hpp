#pragma once

#include "services/resilience/test/fixture.hpp"

namespace trb::resilience::test {

/// Ridgeback's wheels fail in task 4, and the task with them.
inline void wheels_fail(Fixture& fixture) {
  fixture.fault("ridgeback", "mobile");
  fixture.end_task("t4", TaskOutcome::failed, "mobile is broken");
}

}  // namespace trb::resilience::test
