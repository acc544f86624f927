// What a delivery or an answer carries, made from the facts at the moment of sending.
#pragma once

#include "services/scheduler/core/run/run.hpp"

namespace trb::scheduler {

/// The results that count of these tasks and the choices on them, as far as they are held and fit into one message;
/// what does not fit is sent or asked for again.
Results pack_results(const Run& run, const std::vector<TaskIndex>& tasks);

Baton baton_for(const Run& run, const std::vector<TaskIndex>& tasks);

}  // namespace trb::scheduler
