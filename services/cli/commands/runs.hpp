// The runs that a node's scheduler knows: those that are not over, and its archive.
#pragma once

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// `trb run list`, `trb scenario list`.
int list_runs(const Arguments& arguments);

}  // namespace trb::cli
