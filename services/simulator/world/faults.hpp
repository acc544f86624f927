// What goes wrong, and when.
#pragma once

#include <string>
#include <vector>

#include "common/simulation/fault.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::world {

using simulation::Battery;
using simulation::Fault;
using simulation::FaultKind;
using simulation::FaultRate;
using simulation::Way;

/// A rate's failures and repairs of one robot until `limit_s`.
std::vector<Fault> drawn(const Fault& rate, const std::string& robot, double limit_s, Dice& dice);

}  // namespace trb::world
