// Runs trb-simulator, which stands beside trb.
#pragma once

#include "proto/value.hpp"

namespace trb::cli {

/// The answer to a job (services/simulator/README.md). It is ended with this process. Errors: missing (no such
/// program), malformed, io_error, those of the simulator.
Result<Value> run_simulator(const Value& job);

}  // namespace trb::cli
