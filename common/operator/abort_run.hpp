#pragma once

#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

struct AbortWish {
  std::string run;     ///< its id, or a unique beginning of it
  std::string reason;  ///< for the record
  Duration wait = std::chrono::seconds(5);
};

/// Ends a run for good, and reads it until every member has confirmed or `wait` is over: then the view's state is not
/// `aborted`, and it shows what the run waits for, as it was read last. An error means that the order was not accepted:
/// unknown_run, those of Session::request.
void abort_run(Session& session, AbortWish wish, Callback<RunView> done);

}  // namespace trb::op
