#pragma once

#include <functional>
#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

struct FollowWish {
  std::string run;            ///< its id, or a unique beginning of it; empty: the newest
  Duration wait{};            ///< the longest time to follow it
  bool until_paused = false;  ///< also end when it waits for a person
  bool once = false;          ///< read it once only
};

/// True if nothing in the run changes any more: finished, aborted or expired.
bool is_over(RunState state);

/// Reads the run repeatedly. `seen` gets each view with the previous one (an empty one at first); if it returns false,
/// following ends. `done` gets the last view. Errors: unknown_run and those of Session::request at the first read;
/// later, what the scheduler itself says ends it (unknown_run, expired: its record has made room); others are retried
/// until `wait` is over. The run of the first view is followed to the end.
void follow_run(Session& session, FollowWish wish, std::function<bool(const RunView& before, const RunView& view)> seen,
                Callback<RunView> done);

}  // namespace trb::op
