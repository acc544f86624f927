// Shares of measured values: what each alternative gets of one criterion.
//
// benefit (more is better): v / sum(v). cost (less is better): (1 / v) / sum(1 / v). So twice the battery, or half the
// way, counts twice. Units cancel out. All values alike give shares alike, all 0 as well. A cost of 0 is the limit of
// smaller and smaller ones: it takes everything, shared with the others of 0; whoever does not mean that adds what is
// always paid (a way's start, 1 m). Negative values have no ratio and are refused.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/field.hpp"

namespace trb {

enum class Direction : std::uint8_t { benefit, cost };
constexpr auto enum_names(Direction) {
  return std::to_array<std::string_view>({"benefit", "cost"});
}

/// The index of the first value that can have no share: negative, over 1e300, or not a number.
std::optional<std::size_t> find_unusable(std::span<const double> values);

/// Adds weight x share to each score; the shares sum to 1. The values are usable, and as many as the scores.
void add_shares(std::span<const double> values, Direction direction, double weight, std::span<double> scores);

/// The indexes of the `count` best, best first; fewer if there are fewer. Scores are from 0 to 1; those within 1e-12 of
/// each other are ordered by name, so that the answer is the same on every machine.
std::vector<std::size_t> best_of(std::span<const double> scores, std::span<const std::string> names, std::size_t count);

}  // namespace trb
