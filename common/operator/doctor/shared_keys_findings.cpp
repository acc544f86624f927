#include "common/operator/doctor/shared_keys_findings.hpp"

#include <algorithm>

namespace trb::op {
namespace {

constexpr double kProblem = 3600;
constexpr double kTold = 24 * 3600;
/// Dials in a row; a node whose state/ was put back is let in after fewer, once its earlier start's lease has ended.
constexpr std::uint64_t kRefused = 10;

constexpr std::string_view kCure =
    "if one is a copy of yours, stop it: no copied folder may run. Else the keys are stolen: revoke them by their "
    "serial "
    "(trb fleet revoke FLEET_DIR SERIAL --via NODE_DIR), make new ones (trb fleet request, trb fleet sign), and look "
    "at "
    "the robot itself: orders and stops may have gone to the other computer, which may have confirmed them";

std::string ago(double seconds) {
  const auto minutes = static_cast<std::int64_t>(seconds / 60);
  return minutes == 0 ? "" : "; last seen " + std::to_string(minutes) + " min ago";
}

void add(const std::string& subject, const std::string& what, double last_s, std::vector<Finding>& out) {
  const bool told =
      std::ranges::any_of(out, [&](const Finding& f) { return f.cause == "shared_keys" && f.subject == subject; });
  if (told) return;
  out.push_back({last_s <= kProblem ? Weight::problem : Weight::note, "shared_keys", subject, what + ago(last_s),
                 std::string(kCure)});
}

}  // namespace

void add_shared_keys_findings(const Observed& seen, std::vector<Finding>& out) {
  const std::string serial = seen.own ? " (certificate serial " + std::to_string(seen.own->serial) + ")" : "";
  for (const LinkErrorRow& row : seen.errors.errors) {
    if (row.last_s > kTold) continue;
    std::string replaced = row.peer;
    if (row.code == "shared_keys" && (seen.asked.empty() || seen.asked == row.peer)) {
      add(row.peer, row.text, row.last_s, out);
    } else if (row.code == "refused_us" && row.text == "conflict" && row.count >= kRefused) {
      const std::string who = row.peer.empty() ? row.address : row.peer;
      add(seen.node,
          "two computers use this node's keys" + serial + ": another one is linked at " + who +
              ", which therefore refuses this one",
          row.last_s, out);
      replaced = who;
    } else {
      continue;
    }
    std::erase_if(out, [&](const Finding& f) { return f.cause == "old_start" && f.subject == replaced; });
  }
}

}  // namespace trb::op
