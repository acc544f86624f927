// Shared by the tests of common/ranking: judgments as matrices, and numbers that are the same on every machine.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/ranking/ranking.hpp"

namespace trb::ranking_test {

/// The judgments above a matrix' diagonal, row by row.
inline std::vector<Judgment> upper(const std::vector<std::string>& names, const std::vector<double>& values) {
  REQUIRE(values.size() == names.size() * (names.size() - 1) / 2);
  std::vector<Judgment> out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i + 1; j < names.size(); ++j) out.push_back({names[i], names[j], values[out.size()]});
  }
  return out;
}

/// True if it equals the printed number to the printed digits.
inline bool prints(double value, double printed, int digits) {
  return std::abs(value - printed) <= 0.5 * std::pow(10, -digits) + 1e-12;
}

inline void check_prints(const std::vector<double>& values, const std::vector<double>& printed, int digits) {
  REQUIRE(values.size() == printed.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK_MESSAGE(prints(values[i], printed[i], digits), i, ": ", values[i], " is printed as ", printed[i]);
  }
}

/// Lehmer's generator.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 2 + 1) {}
  double between(double from, double to) {
    state_ = state_ * 48271 % 2147483647;
    return from + (to - from) * static_cast<double>(state_) / 2147483647.0;
  }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(between(0, static_cast<double>(count) - 1e-6));
  }

 private:
  std::uint64_t state_;
};

}  // namespace trb::ranking_test
