#pragma once

#include <functional>
#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

struct FollowWish {
  std::string run;            ///< its id, or a unique beginning of it; empty: the newest
  Duration wait{};            ///< the longest time to follow it
  bool until_paused = false;  ///< end as well when it waits for a person
  bool once = false;          ///< one look only
};

/// True if nothing of the run changes any more: finished, aborted or expired.
bool is_over(RunState state);

/// Looks at the run again and again. Each view is shown to `seen` with the one before it (an empty one at first); if
/// that returns false, the run is followed no further. `done` gets the last view. Errors: unknown_run and those of
/// Session::request at the first look; later ones are tried again until `wait` is over.
void follow_run(Session& session, FollowWish wish, std::function<bool(const RunView& before, const RunView& view)> seen,
                Callback<RunView> done);

}  // namespace trb::op
