#pragma once

#include "common/operator/session.hpp"

namespace trb::op {

/// Checks that it is clear what is decided on: an alert, or a run and its tasks. Errors: missing.
Status check_subject(const AlertDecide& decision);

/// The same, and that the verdict has all it needs. Errors: missing.
Status check_decision(const AlertDecide& decision);

/// Sends a person's decision to the node's resilience, and from there to the cloud node that decides on the run. `done`
/// gets the answer once the decision is made. Errors: those of check_decision and Session::request; conflict,
/// unknown_target (by a Nack).
void decide(Session& session, const AlertDecide& decision, const Callback<Ack>& done);

}  // namespace trb::op
