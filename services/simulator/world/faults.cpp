#include "services/simulator/world/faults.hpp"

namespace trb::world {

/// Without the math library: a thousand draws a mean time, each of one in a thousand.
std::optional<double> time_to_failure(double mean_s, double at_most_s, Dice& dice) {
  constexpr std::uint32_t kThousandth = 1000;  // in millionths
  const double step = mean_s / 1000;
  for (double out = step; out < at_most_s; out += step) {
    if (dice.chance(kThousandth)) return out;
  }
  return std::nullopt;
}

}  // namespace trb::world
