// How long a simulated robot works, and what it tells then.
#pragma once

#include <string>

namespace trb::simulation {

/// What a skill takes, in seconds. A deviation of 0: each time as long. `result` is JSON, for tasks that take a value
/// from this one; empty: it tells none.
struct SkillTime {
  double mean_s = 3;
  double deviation_s = 0;
  std::string result = {};
};

}  // namespace trb::simulation
