// The best of many robots: the AHP's scores by measured values, without an explanation of each.
#pragma once

#include <span>
#include <vector>

#include "services/resilience/core/best_scored.hpp"
#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// Global weights of the paper's criteria, as rank() computes them; 0 leaves one out (a task without a place:
/// distance).
struct Weights {
  double charge = 0;
  double distance = 0;
  double availability = 0;
};

/// Added to every distance, in m: else a robot at the place would take the distance's whole weight.
constexpr double kWayStart = 1;

/// The best of the robots, best first; of equals the one with the smaller number. Charge and availability are benefits,
/// the distance to the place (plus kWayStart) is a cost. Shares are computed as in common/ranking, among all of the
/// robots; a robot has no share of an unknown value.
std::vector<Scored> shortlist(const FleetIndex& index, std::span<const RobotNumber> robots, const Weights& weights,
                              HallPoint place, std::size_t most);

}  // namespace trb::resilience
