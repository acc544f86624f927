// --fleet and --key: the public half of the fleet that a proof is checked against.
#pragma once

#include "common/security/authority.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// Errors: missing (neither of the two), bad_value (--key), and those of read_fleet.
Result<FleetAuthority> authority_of(const Arguments& arguments);

}  // namespace trb::cli
