// Messages that have passed the router, as JSON: for the API and for the live stream alike.
#pragma once

#include <string>

#include "services/cloud-gateway/core/live/message_log.hpp"

namespace trb::gateway {

/// {"number", "time", "direction", "phase", and those of `trb tap --json`}; of one without its data "cut": true, and
/// its size.
std::string json_message(const PassedMessage& passed);
/// {"boot": 12, ...}: of each phase of Equation 12.
std::string json_phases(const MessageLog::PhaseCounts& counts);

}  // namespace trb::gateway
