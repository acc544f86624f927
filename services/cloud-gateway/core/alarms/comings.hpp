// What counts as one coming of a source of alarms: one fault of a robot that three runs need raises three alerts, and
// has come once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::gateway {

/// Alerts of different runs that begin so soon after each other have come together.
constexpr Duration kTogether = std::chrono::seconds(2);

/// By alert, when the coming began that it belongs to. It belongs to an earlier one's if that is of another run and is
/// open, or began just before; but a run counts a coming once, so each further alert of it is a new one. `alerts`: all
/// of one source, earliest first. `known`: alerts that keep what was found when they were new.
std::map<std::string, UtcTime> comings_of(const std::vector<const Alert*>& alerts,
                                          const std::map<std::string, UtcTime>& known);

}  // namespace trb::gateway
