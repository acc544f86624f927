// What goes wrong, and when.
#pragma once

#include <optional>

#include "common/simulation/fault.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::world {

using simulation::Battery;
using simulation::Fault;
using simulation::FaultKind;
using simulation::FaultRate;
using simulation::Way;

/// By chance, after `mean_s` in the mean; exponential. nullopt: not within `at_most_s`.
std::optional<double> time_to_failure(double mean_s, double at_most_s, Dice& dice);

}  // namespace trb::world
