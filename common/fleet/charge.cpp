#include "common/fleet/charge.hpp"

#include <algorithm>

namespace trb {

std::optional<double> full_battery(const NodeProfile& profile) {
  if (profile.mode == "ros") return 1.0;
  if (profile.transport == "udp-at") return 100.0;
  // The user's own program, with fields.
  if (profile.mode == "interpreter" && (profile.transport.empty() || profile.transport == "lines")) return 100.0;
  return std::nullopt;
}

std::string_view charge_request(const NodeProfile& profile) {
  const auto& names = profile.sensors;
  const bool tells_percent = std::ranges::find(names, kChargeRequests[0]) != names.end();
  return tells_percent || !full_battery(profile) ? kChargeRequests[0] : kChargeRequests[1];
}

bool moves(const NodeProfile& profile) {
  return std::ranges::any_of(profile.capabilities,
                             [](const std::string& word) { return word == "mobile" || word == "fly"; });
}

}  // namespace trb
