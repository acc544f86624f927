#pragma once

#include <cstdint>
#include <string>

#include "common/operator/plan_run.hpp"

namespace trb::op {

struct RunTerms {
  double expires_h = 24;       ///< no task of it starts later than this many hours from now
  std::uint32_t priority = 0;  ///< of two runs that want the same robot, the higher one begins: 0 to 9
};

/// Builds the start of a planned run, has it signed, and submits it to the node's scheduler. `done` gets the run's id;
/// from then on the run does not need this session. Without an answer it is submitted once more. Errors:
/// unknown_target (a node that was never seen); not_confirmed, with the run's id, if the second has no answer either:
/// the run may still begin; those of Session::request.
void submit_run(Session& session, RunPlan plan, const RunTerms& terms, const Callback<std::string>& done);

}  // namespace trb::op
