// Sends what a run owes to other members, and asks them for what it needs of them.
#pragma once

#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// At a step's end: the decider passes on what others should have passed on by now, all that is due is sent, and
/// results that are missing are asked for.
void send_due(Run& run, Step step);

}  // namespace trb::scheduler
