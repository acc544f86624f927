// What the doctor finds of use: robots that are out of it, a scheduler that has nearly no room for runs.
#pragma once

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A fault of the own robot is a problem, of another one a note; so is a retired robot.
void add_use_findings(const Observed& seen, std::vector<Finding>& out);

}  // namespace trb::op
