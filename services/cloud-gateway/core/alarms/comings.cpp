#include "services/cloud-gateway/core/alarms/comings.hpp"

#include <set>
#include <utility>

#include "services/cloud-gateway/core/alarms/alarm.hpp"

namespace trb::gateway {

std::map<std::string, UtcTime> comings_of(const std::vector<const Alert*>& alerts,
                                          const std::map<std::string, UtcTime>& known) {
  std::map<std::string, UtcTime> out;
  std::set<std::pair<std::string, std::int64_t>> counted;  // run and coming
  const auto coming_of = [&](std::size_t index) -> UtcTime {
    const Alert& one = *alerts[index];
    if (const auto at = known.find(one.id); at != known.end()) return at->second;
    for (std::size_t i = index; i-- > 0;) {
      const Alert& other = *alerts[i];
      const bool together = is_open(other) || one.time - other.time <= kTogether.count();
      const UtcTime coming = out.at(other.id);
      if (other.run != one.run && together && !counted.contains({one.run, coming.ns})) return coming;
    }
    return {one.time};
  };
  for (std::size_t i = 0; i < alerts.size(); ++i) {
    const UtcTime coming = coming_of(i);
    out[alerts[i]->id] = coming;
    counted.insert({alerts[i]->run, coming.ns});
  }
  return out;
}

}  // namespace trb::gateway
