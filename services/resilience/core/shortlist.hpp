// The best of many by a weighted sum, so that only a few are ranked and explained in full.
#pragma once

#include <span>
#include <vector>

#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// What each measure counts; not negative.
struct Weights {
  double charge = 1;
  double distance = 1;  ///< 0 if the task has no place
  double availability = 1;
};

struct Scored {
  RobotNumber robot = 0;
  double score = 0;
};

/// The best of the robots, best first; of equals the one with the smaller number. Charge and availability count as
/// parts of 100, a distance as the nearest one's part of it. What is unknown counts nothing.
std::vector<Scored> shortlist(const FleetIndex& index, std::span<const RobotNumber> robots, const Weights& weights,
                              HallPoint place, std::size_t most);

}  // namespace trb::resilience
