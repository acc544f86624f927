// A run of a world: what is planned of it, what its robots did, and what became of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/simulator/world/run_plan.hpp"
#include "services/simulator/world/standstill.hpp"
#include "services/simulator/world/witness.hpp"

namespace trb::world {

/// What became of a run. Times are the world's, in seconds.
struct PlayedRun {
  bool accepted = false;          ///< by the cloud's scheduler
  std::string refusal;            ///< why it was refused; empty: it was not
  std::optional<RunState> state;  ///< at the cloud, from when its disk has the run's end, as people see it in the hall
  bool over_everywhere = false;
  double submitted_s = 0;  ///< when the person submitted it; 0: the world ended before
  double makespan_s = 0;
  std::size_t tasks_done = 0;
  bool cut_off = false;                  ///< the time was up before it was over
  bool left_open = false;                ///< and it was under way then, or need not end: that it is open is no fault
  std::optional<Standstill> standstill;  ///< why it is not over, if it was cut off
  std::vector<std::string> broken;       ///< invariants that do not hold, as text
};

struct WorldRun {
  std::size_t index = 0;  ///< 0: the first one
  std::string id;
  PlannedRun plan;
  Witness witness;
  PlayedRun outcome{};
};

}  // namespace trb::world
