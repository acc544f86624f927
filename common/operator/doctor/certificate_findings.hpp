// What the doctor concludes of the node's own certificate: that it has ended, ends soon, or has not begun by this
// clock.
#pragma once

#include <vector>

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A note in its last 30 days; a problem before it begins and once it has ended.
void add_certificate_findings(const Observed& seen, std::vector<Finding>& out);

}  // namespace trb::op
