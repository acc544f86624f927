#include "services/cloud-gateway/core/alarms/chatter.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

bool is_within(UtcTime from, UtcTime to, Duration time) {
  return to.ns - from.ns <= time.count();
}

}  // namespace

std::uint32_t chatter(std::vector<UtcTime> came, UtcTime now) {
  std::ranges::sort(came, {}, &UtcTime::ns);
  bool chatters = false;
  std::uint32_t times = 0;
  for (std::size_t i = 0; i < came.size(); ++i) {
    if (i > 0 && !is_within(came[i - 1], came[i], kChatterQuiet)) {
      chatters = false;
      times = 0;
    }
    ++times;
    const std::size_t before = kChatterTimes - 1;
    if (times >= kChatterTimes && is_within(came[i - before], came[i], kChatterWithin)) chatters = true;
  }
  return chatters && is_within(came.back(), now, kChatterQuiet) ? times : 0;
}

}  // namespace trb::gateway
