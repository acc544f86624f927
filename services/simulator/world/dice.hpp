// The world's chance: the same numbers for the same seed on every machine, and so without the math library.
#pragma once

#include <cstdint>

#include "common/base/time.hpp"

namespace trb::world {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15U + 1) {}

  std::uint64_t next() {
    std::uint64_t mixed = state_ += 0x9E3779B97F4A7C15U;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    return mixed ^ (mixed >> 31U);
  }
  std::uint64_t below(std::uint64_t end) { return next() % end; }
  std::uint64_t from(std::uint64_t first, std::uint64_t last) { return first + below(last - first + 1); }
  template <class Container>
  const auto& one_of(const Container& all) {
    return all[below(all.size())];
  }
  bool percent(std::uint64_t chance) { return below(100) < chance; }
  /// With a probability in millionths.
  bool chance(std::uint32_t millionths) { return millionths != 0 && below(1'000'000) < millionths; }
  /// About normal (the sum of twelve even draws), never below 0.
  Duration normal(Duration mean, Duration deviation) {
    if (deviation.count() == 0) return mean;
    std::int64_t sum = 0;
    for (int i = 0; i < 12; ++i) sum += static_cast<std::int64_t>(below(1'000'001));
    const std::int64_t off = (sum - 6'000'000) * (deviation.count() / 1000) / 1000;
    return Duration{mean.count() + off < 0 ? 0 : mean.count() + off};
  }

 private:
  std::uint64_t state_;
};

}  // namespace trb::world
