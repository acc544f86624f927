#pragma once

#include "common/operator/session.hpp"

namespace trb::op {

/// Whether it is clear what is decided on: an alert, or a run and its tasks. Errors: missing.
Status check_subject(const AlertDecide& decision);

/// The same, and whether the verdict says what it must. Errors: missing.
Status check_decision(const AlertDecide& decision);

/// Gives a person's decision to the node's resilience, which must be the one that decides. `done` gets its answer, once
/// the decision is taken. Errors: those of check_decision and Session::request; conflict, unknown_target (by a Nack).
void decide(Session& session, const AlertDecide& decision, const Callback<Ack>& done);

}  // namespace trb::op
