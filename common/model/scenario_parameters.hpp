// The paper's variables, read off a scenario.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/model/paper.hpp"
#include "proto/bodies/run.hpp"

namespace trb::model {

struct ScenarioParameters {
  PaperParameters paper;
  /// What had to be assumed, a sentence each: tasks without a robot, conditions that name no node.
  std::vector<std::string> assumed;
};

/// `interpreted`: the robots whose mode is interpreter. The tasks count in the order of the file, as they do in Figure
/// 9: a block is a row of tasks of one robot, and a task without a robot counts as another actor's. n is the number of
/// robots it names (at least 1), s of the sensors. A condition is a request by the robot that evaluates it
/// (chooser_of): local if its sensor is at that robot, or there is no other. delta_t, sum_x and N_f are no part of a
/// scenario and stay 0; k is 1 for one robot's tasks. The scenario must have passed check_graph.
ScenarioParameters parameters_of(const Scenario& scenario, const std::set<std::string>& interpreted);

/// A fleet has the robots that the scenario names. Errors: bad_value, naming `trb model`'s option.
Status check_named(const Scenario& scenario, std::uint64_t robots);

}  // namespace trb::model
