#include "services/simulator/world/faults.hpp"

namespace trb::world {
namespace {

/// Exponential without the math library: a thousand draws a mean time, each of one in a thousand.
double time_to_failure(double mean_s, double at_most_s, Dice& dice) {
  constexpr std::uint32_t kThousandth = 1000;  // in millionths
  const double step = mean_s / 1000;
  double out = step;
  while (out < at_most_s && !dice.chance(kThousandth)) out += step;
  return out;
}

}  // namespace

std::vector<Fault> drawn(const Fault& rate, const std::string& robot, double limit_s, Dice& dice) {
  constexpr std::size_t kMost = 1000;
  std::vector<Fault> out;
  double at = 0;
  while (out.size() < kMost) {
    at += time_to_failure(rate.rate.between_s, limit_s - at, dice);
    if (at >= limit_s) break;
    out.push_back({at, FaultKind::fail, robot});
    if (!rate.rate.repair_s) break;
    at += *rate.rate.repair_s;
    out.push_back({at, FaultKind::repair, robot});
  }
  return out;
}

}  // namespace trb::world
