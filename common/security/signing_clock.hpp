// Can the clock of the authority's computer be right? What is signed begins, and a revocation is needed, by it: a clock
// that is a year ahead would make every member one that has ended.
#pragma once

#include <optional>

#include "common/security/authority.hpp"

namespace trb {

/// The yearly renewal, and some days more, may lie between two uses of the folder.
constexpr Duration kLongestUnused = std::chrono::hours(24 * 380);
/// A node that was off for long has not noted the time since.
constexpr Duration kLongestNodeOff = std::chrono::hours(24 * 30);
constexpr Duration kSigningBehind = std::chrono::minutes(5);

/// Errors: conflict: `now` is before what the folder has signed, or what the node has noted (`node`; nullopt: no node
/// is asked, or it has noted nothing yet), or long after it.
Status check_signing_clock(const Authority& authority, std::optional<UtcTime> node, UtcTime now);

/// Errors: conflict: by this clock every certificate of a node that was never revoked has ended. The next list would
/// bring nobody the beacon key.
Status check_members_clock(const Authority& authority, UtcTime now);

}  // namespace trb
