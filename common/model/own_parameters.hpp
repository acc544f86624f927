// The variables of our own protocol's model, read off a scenario.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/model/own_protocol.hpp"
#include "proto/bodies/run.hpp"

namespace trb::model {

/// `tasks` tasks, given to the robots in turn, one after the other (the paper's).
Scenario tasks_in_turn(std::size_t robots, std::size_t tasks);

/// N, M, B, S, K, G, E, R of a run without faults, n the robots it names (at least 1), and T: until the last robot is
/// let go. `assigned`: who has each task (empty: whom it names; a task that names none has a robot of its own). Each
/// task takes `task_s` seconds; a robot begins what is ready in the order of the file. A condition is a remote request
/// unless its sensor is at the robot that evaluates it. The scenario must have passed check_graph.
OwnParameters own_parameters_of(const Scenario& scenario, const std::vector<std::string>& assigned, double task_s);

}  // namespace trb::model
