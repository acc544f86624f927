// Finds tasks that wait for each other in a circle.
#pragma once

#include <vector>

#include "proto/bodies/run.hpp"

namespace trb {

/// Some cycles of the graph, 8 at most; empty exactly if it has none. Each is the indexes of its tasks in the order in
/// which they would run, without repeating the first at the end. Every predecessor must be the index of a task.
std::vector<std::vector<std::size_t>> find_cycles(const Scenario& scenario);

}  // namespace trb
