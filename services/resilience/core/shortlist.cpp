#include "services/resilience/core/shortlist.hpp"

#include <cmath>

#include "common/ranking/shares.hpp"
#include "services/resilience/core/best_scored.hpp"

namespace trb::resilience {
namespace {

constexpr double kNever = 1e300;  ///< m: the distance of a robot at an unknown position

double known_or(double value, double otherwise) {
  return std::isnan(value) ? otherwise : value;
}

double way(const Measures& of, HallPoint place) {
  const double east = of.x - place.x;
  const double north = of.y - place.y;
  return known_or(kWayStart + std::sqrt(east * east + north * north), kNever);
}

}  // namespace

std::vector<Scored> shortlist(const FleetIndex& index, std::span<const RobotNumber> robots, const Weights& weights,
                              HallPoint place, std::size_t most) {
  std::vector<double> charges(robots.size()), ways(robots.size()), availabilities(robots.size()), scores(robots.size());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Measures& of = index.measures(robots[i]);
    charges[i] = known_or(of.charge, 0);
    ways[i] = way(of, place);
    availabilities[i] = of.availability;
  }
  add_shares(charges, Direction::benefit, weights.charge, scores);
  add_shares(ways, Direction::cost, weights.distance, scores);
  add_shares(availabilities, Direction::benefit, weights.availability, scores);
  BestScored best(most);
  for (std::size_t i = 0; i < robots.size(); ++i) best.add({robots[i], scores[i]});
  return best.take();
}

}  // namespace trb::resilience
