#include "common/security/signing_clock.hpp"

#include <algorithm>
#include <limits>

namespace trb {
namespace {

/// Of the list and the certificate that were signed last; 0: none was. What was signed before them by a wrong clock
/// counts no more once others are signed by a right one.
UtcTime last_signed(const Authority& authority) {
  const auto newest = std::ranges::max_element(authority.issued, {}, &Certificate::serial);
  if (newest == authority.issued.end()) return {authority.list.issued};
  return {std::max(authority.list.issued, newest->not_before)};  // it begins somewhat before it is signed
}

Status wrong_clock(UtcTime now, const std::string& why) {
  return fail(Errc::conflict, "the clock of this computer says " + to_iso8601(now) + ", but " + why,
              "set it (date, timedatectl); if it is right, say so with --trust-clock");
}

}  // namespace

Status check_signing_clock(const Authority& authority, std::optional<UtcTime> node, UtcTime now) {
  const UtcTime last = last_signed(authority);
  if (now + kSigningBehind < last) return wrong_clock(now, "the folder has signed at " + to_iso8601(last));
  if (node && now + kSigningBehind < *node) return wrong_clock(now, "the node knows that it is " + to_iso8601(*node));
  if (last.ns != 0 && now > last + kLongestUnused)
    return wrong_clock(now, "the folder has signed nothing since " + to_iso8601(last));
  if (node && now > *node + kLongestNodeOff) return wrong_clock(now, "the node has last noted " + to_iso8601(*node));
  return Done{};
}

Status check_members_clock(const Authority& authority, UtcTime now) {
  constexpr UtcTime ever{std::numeric_limits<std::int64_t>::min()};
  bool has_member = false;
  for (const Certificate& row : authority.issued) {
    if (find_living(authority, row.id, now) != nullptr) return Done{};
    has_member = has_member || find_living(authority, row.id, ever) != nullptr;
  }
  if (!has_member) return Done{};
  return wrong_clock(now, "then the certificates of all nodes have ended");
}

}  // namespace trb
