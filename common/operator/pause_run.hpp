#pragma once

#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

/// Holds a run (running tasks finish, none begins), or lets it continue. `run` is its id, or a unique beginning of it;
/// `reason` is for the record. `done` gets the resulting run; if it cannot be read once the order is accepted, as it
/// was, with the order. An error means that the order was not accepted: unknown_run, those of Session::request.
void pause_run(Session& session, const std::string& run, const std::string& reason, const Callback<RunView>& done);
void resume_run(Session& session, const std::string& run, const std::string& reason, const Callback<RunView>& done);

}  // namespace trb::op
