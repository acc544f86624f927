// What `trb simulate` says of a played run besides its messages and tasks: how it ended, and if it did not, why; what
// went wrong meanwhile, and what of the plan was not reached.
#pragma once

#include "proto/value.hpp"

namespace trb::cli {

/// Lines to standard output. `answer`: the simulator's, of a job with the real cores; of all its runs.
void print_run_end(const Value& answer);

/// As `trb scenario watch`: kGood if each run is FINISHED, else kFailed; also kFailed if something is BROKEN.
int exit_code_of(const Value& answer);

}  // namespace trb::cli
