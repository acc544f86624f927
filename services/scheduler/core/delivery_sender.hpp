// Sends what a run owes to other members, and requests what it needs of them. What a delivery carries is made from
// the facts at the moment of sending.
#pragma once

#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// At a step's end: the decider passes on what others should have passed on by now, all that is due is sent, and
/// results that are missing are requested.
void send_due(Run& run, Step step);

/// The results that count of these tasks and the choices on them, as far as they are held and fit into one message;
/// what does not fit is sent or asked for again.
Results pack_results(const Run& run, const std::vector<TaskIndex>& tasks);

}  // namespace trb::scheduler
