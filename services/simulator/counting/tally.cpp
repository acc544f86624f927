#include "services/simulator/counting/tally.hpp"

#include <algorithm>
#include <cmath>

namespace trb::counting {
namespace {

void add(Count& to, const Count& more) {
  to.messages += more.messages;
  to.bytes += more.bytes;
}

Count sum_of(const std::array<Count, kPhases>& counts) {
  Count out;
  for (const Count& one : counts) add(out, one);
  return out;
}

}  // namespace

Tally::Tally(double seconds) {
  interval_s_ = std::max(1.0, std::ceil(seconds / static_cast<double>(kMaxIntervals)));
  over_time_.resize(static_cast<std::size_t>(std::min(seconds / interval_s_, 1.0 * kMaxIntervals)) + 1);
}

void Tally::add(double at_s, CostPhase phase, std::uint64_t bytes, bool between_computers) {
  add(at_s, phase, Count{1, bytes}, between_computers);
}

void Tally::add_bytes(double at_s, CostPhase phase, std::uint64_t bytes) {
  add(at_s, phase, Count{0, bytes}, true);
}

void Tally::add(double at_s, CostPhase phase, const Count& one, bool between_computers) {
  trb::counting::add(all_[static_cast<std::size_t>(phase)], one);
  if (between_computers) trb::counting::add(between_[static_cast<std::size_t>(phase)], one);
  const auto interval = static_cast<std::size_t>(at_s / interval_s_);
  trb::counting::add(over_time_[std::min(interval, over_time_.size() - 1)], one);
}

Count Tally::all() const {
  return sum_of(all_);
}

Count Tally::between() const {
  return sum_of(between_);
}

}  // namespace trb::counting
