// How long a simulated robot works.
#pragma once

namespace trb::simulation {

/// What a skill takes, in seconds. A deviation of 0: each time as long.
struct SkillTime {
  double mean_s = 3;
  double deviation_s = 0;
};

}  // namespace trb::simulation
