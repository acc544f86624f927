// Findings about keys that two computers use: a copied folder that runs, or a thief.
#pragma once

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A problem for an hour after the last sign, then a note for a day: whoever looks later must learn of it, too. It
/// takes the place of what the same node was reproached with as an older start.
void add_shared_keys_findings(const Observed& seen, std::vector<Finding>& out);

}  // namespace trb::op
