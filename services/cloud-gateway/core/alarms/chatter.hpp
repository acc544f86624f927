// When an alarm comes and goes so often that it must not call people each time.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/time.hpp"

namespace trb::gateway {

constexpr std::size_t kChatterTimes = 3;
constexpr Duration kChatterWithin = std::chrono::seconds(60);
constexpr Duration kChatterQuiet = std::chrono::minutes(5);

/// An alarm chatters once it has come 3 times within 60 s, until it has not come for 5 min. `came`: when it came, in
/// any order. Returns how often it came since the last quiet; 0: it does not chatter.
std::uint32_t chatter(std::vector<UtcTime> came, UtcTime now);

}  // namespace trb::gateway
