// A scenario in a request's body, and its faults in a reply.
#pragma once

#include <string>

#include "common/operator/scenario_check.hpp"
#include "services/cloud-gateway/io/api/call.hpp"

namespace trb::gateway {

/// Stands for the body in faults.
constexpr const char* kScenarioFile = "scenario";

/// The scenario in the object's member "scenario", or the object itself. Its faults are added to `faults`.
Scenario scenario_of(const Value& json, ConfigFaults& faults);

/// A problem with all of them.
HttpReply faults_reply(const ConfigFaults& faults);

/// [{"pointer", "detail", "hint", "warning"}]
std::string json_scenario_faults(const ConfigFaults& faults);
/// [{"task", "robot", "why"}]
std::string json_no_spares(const std::vector<NoSpare>& without);

}  // namespace trb::gateway
