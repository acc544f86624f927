// --via and the clock of the commands that sign: before they do, the authority's folder takes over what a node that is
// up knows, and the clock is compared with both.
#pragma once

#include <optional>
#include <string>

#include "common/security/authority.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

const std::string kTrustClock = "--trust-clock|sign also if this computer's clock contradicts what was signed before";

/// What the folder has learnt of the node.
struct Learned {
  bool is_news = false;        ///< the folder was older than what the node knows
  std::optional<UtcTime> utc;  ///< the node has noted that this time is over
};

/// Before anything is signed: of a mistyped folder nothing is learnt, and nothing is handed on by it. Errors: missing.
Status check_via(const Arguments& arguments);

/// A node knows what the folder does not, if that is an older copy of itself: by its files, and if it is up by the
/// certificates of all that it has met. A note says so. An empty `via`: nothing. Errors: those of its files and of
/// catch_up().
Result<Learned> learn_from(Authority& authority, const Arguments& arguments, const std::string& via);

/// Errors: those of check_signing_clock(), but with --trust-clock.
Status check_clock(const Arguments& arguments, const Authority& authority, const Learned& learned, UtcTime now);

}  // namespace trb::cli
