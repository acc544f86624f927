// The best of many robots: the AHP's scores by measured values, without an answer that explains each of them.
#pragma once

#include <span>
#include <vector>

#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// Global weights of the paper's criteria, as rank() tells them; 0 leaves one out (a task without a place: distance).
struct Weights {
  double charge = 0;
  double distance = 0;
  double availability = 0;
};

struct Scored {
  RobotNumber robot = 0;
  double score = 0;
  bool operator==(const Scored&) const = default;
};

/// What is always paid, m: who stands at the place would otherwise take the distance's whole weight.
constexpr double kWayStart = 1;

/// The best of the robots, best first; of equals the one with the smaller number. Charge and availability are benefits,
/// the distance to the place (and kWayStart) a cost, their shares those of common/ranking, among all of the robots. Of
/// what is unknown a robot has no share.
std::vector<Scored> shortlist(const FleetIndex& index, std::span<const RobotNumber> robots, const Weights& weights,
                              HallPoint place, std::size_t most);

}  // namespace trb::resilience
