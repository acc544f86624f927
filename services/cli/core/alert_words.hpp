// What trb says of an alert: what is lost, who could take over, how long that holds.
#pragma once

#include <string>

#include "common/base/time.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::cli {

/// What the robot cannot do any more; some alerts are of no loss.
std::string lost_of(const Alert& alert);

/// The policy, and until when the proposals hold; empty: nobody can take its tasks over.
std::string hold_text(const Alert& alert, UtcTime now);

/// "battery 80 % (0.12)": the value, and what it gave to the score; before it whose it is, if several take over. A
/// value that nobody has measured is "not known": the number is 0 or the others' mean, for the sum's sake.
std::string part_text(const Proposal& proposal, const CriterionPart& part);

}  // namespace trb::cli
