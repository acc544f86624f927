#pragma once

#include <cstdint>
#include <string>

#include "common/operator/plan_run.hpp"

namespace trb::op {

struct RunTerms {
  double expires_h = 24;       ///< nothing of it starts later than so many hours from now
  std::uint32_t priority = 0;  ///< of two runs that want a robot the higher one begins: 0 to 9
};

/// Builds the start of a planned run, has it signed, and submits it to the node's scheduler. `done` gets the run's id;
/// from then on the run goes on without this session. Errors: unknown_target (a node that was never heard), those of
/// Session::request.
void submit_run(Session& session, RunPlan plan, const RunTerms& terms, const Callback<std::string>& done);

}  // namespace trb::op
