// What the doctor concludes of one service: that it is missing; and from where only its key is, its container.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// A robot's node may do without a mode-adapter, for a service of the operator's own; mostly it was forgotten.
constexpr std::string_view kNoModeAdapter =
    R"("services" of node.json has no "mode-adapter": nothing talks to the robot, unless a service of your own does)";
constexpr std::string_view kAddModeAdapter = R"(add "mode-adapter" to "services" in node.json, then restart the node)";

/// A robot's node whose node.json has no mode-adapter, and that none is seen on: nothing says that its robot is silent.
/// A note if it has a service of the operator's own, which may be the one.
void add_missing_adapter(const Observed& seen, std::vector<Finding>& out);

/// A fault of the node's files.
Finding finding_of(const ConfigFault& fault);

/// Problems first; empty if all is well with it. Of `seen` counts what its container shows: files, disk, clock, and how
/// the router answers it.
std::vector<Finding> diagnose_service(const Observed& seen, const std::string& service);

}  // namespace trb::op
