// Findings about use: robots that are out of use, a scheduler with little room left for runs, or that has seen a task
// done twice.
#pragma once

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A fault of the own robot is a problem, that of another robot a note; so is a retired robot.
void add_use_findings(const Observed& seen, std::vector<Finding>& out);

}  // namespace trb::op
