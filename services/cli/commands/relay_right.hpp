// --relay and --no-relay of `trb fleet sign` and `trb fleet renew`.
#pragma once

#include <string>

#include "common/security/authority.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

const std::string kRelay = "--relay|it may carry messages between members that cannot reach each other (a cloud may)";
const std::string kNoRelay = "--no-relay|it may not, though it is a cloud, or might before";

/// Errors: bad_value if both are given.
inline Result<RelayRight> relay_right(const Arguments& arguments) {
  const bool yes = arguments.has("--relay");
  const bool no = arguments.has("--no-relay");
  if (yes && no) return fail(Errc::bad_value, "--relay and --no-relay", "give one of them, or none");
  return yes ? RelayRight::yes : no ? RelayRight::no : RelayRight::by_role;
}

}  // namespace trb::cli
