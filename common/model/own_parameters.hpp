// The variables of our own protocol's model, read off a scenario.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "common/model/own_protocol.hpp"
#include "proto/bodies/run.hpp"

namespace trb::model {

/// `tasks` tasks, given to the robots in turn, one after the other (the paper's).
Scenario tasks_in_turn(std::size_t robots, std::size_t tasks);

/// How long each task of it takes: `usual` seconds, or what `times` says of its skill, or of it alone ("task:ID").
std::vector<double> task_times(const Scenario& scenario, const std::map<std::string, double>& times, double usual);

/// N, M, B, S, K, G, E, Q, R, W of a run without faults, n the robots it names (at least 1), and T: until the last
/// robot is let go. A task that names no robot is bound late; `assigned` says to whom (empty: to a robot of its own).
/// `task_s`: how long each task takes; a robot begins what is ready in the order of the file. A condition is a remote
/// request unless its sensor is at the robot that evaluates it. The scenario must have passed check_graph.
OwnParameters own_parameters_of(const Scenario& scenario, const std::vector<std::string>& assigned,
                                const std::vector<double>& task_s);
/// All take equally long.
OwnParameters own_parameters_of(const Scenario& scenario, const std::vector<std::string>& assigned, double task_s);

}  // namespace trb::model
