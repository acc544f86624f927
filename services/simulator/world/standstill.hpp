// Why a run was not over when its time was up: what waits for a person, whether anything moves, where it is open.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "proto/bodies/resilience.hpp"

namespace trb::world {

class World;
struct WorldRun;

/// Nobody has begun or done a task for so long: it stands still. A run's end takes a minute.
constexpr double kStill_s = 120;

struct Standstill {
  std::vector<Alert> alerts;         ///< the run's, which wait for a person: in a world nobody decides them
  std::vector<std::string> open_at;  ///< nodes on whose disk the run is not over
  std::vector<std::string> off;      ///< of these, whose processes do not run
  std::size_t at_work = 0;           ///< robots that work at a task of the run
  bool is_finished = false;          ///< on the cloud's disk it is: nodes keep a run for a minute more
  double still_s = 0;                ///< nothing has moved for so long and nothing planned is to come; 0: something may
};

/// Of a run of a world that was played until its time was up.
Standstill standstill_of(const World& world, const WorldRun& run);

}  // namespace trb::world
