// What the doctor concludes of one service alone, from where only that service's key is: its container.
#pragma once

#include <string>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A fault of the node's files.
Finding finding_of(const ConfigFault& fault);

/// Problems first; empty if all is well with it. Of `seen` counts what its container shows: files, disk, clock, and how
/// the router answers it.
std::vector<Finding> diagnose_service(const Observed& seen, const std::string& service);

}  // namespace trb::op
