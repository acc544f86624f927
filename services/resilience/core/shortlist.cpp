#include "services/resilience/core/shortlist.hpp"

#include <algorithm>
#include <cmath>

namespace trb::resilience {
namespace {

/// m²: nearer than 10 cm is there.
constexpr double kThere = 0.01;

double squared_distance(const Measures& of, HallPoint place) {
  const double east = of.x - place.x;
  const double north = of.y - place.y;
  return std::max(kThere, east * east + north * north);
}

double known(double value) {
  return std::isnan(value) ? 0 : value;
}

bool better(const Scored& a, const Scored& b) {
  return a.score != b.score ? a.score > b.score : a.robot < b.robot;
}

}  // namespace

std::vector<Scored> shortlist(const FleetIndex& index, std::span<const RobotNumber> robots, const Weights& weights,
                              HallPoint place, std::size_t most) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const RobotNumber robot : robots) {
    const Measures& of = index.measures(robot);
    if (!std::isnan(of.x)) nearest = std::min(nearest, squared_distance(of, place));
  }
  std::vector<Scored> best;  // a heap, the worst of them on top
  for (const RobotNumber robot : robots) {
    const Measures& of = index.measures(robot);
    const double nearness = std::isnan(of.x) ? 0 : std::sqrt(nearest / squared_distance(of, place));
    const Scored scored{robot, weights.charge * known(of.charge) / 100 + weights.distance * nearness +
                                   weights.availability * of.availability / 100};
    if (best.size() == most && (most == 0 || !better(scored, best.front()))) continue;
    best.push_back(scored);
    std::push_heap(best.begin(), best.end(), better);
    if (best.size() <= most) continue;
    std::pop_heap(best.begin(), best.end(), better);
    best.pop_back();
  }
  std::sort_heap(best.begin(), best.end(), better);
  return best;
}

}  // namespace trb::resilience
