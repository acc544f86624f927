#include "common/ranking/shares.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace trb {
namespace {

constexpr double kGreatest = 1e300;  // keeps the sum of all values finite

constexpr double kStep = 1e-12;

std::int64_t in_steps(double score) {
  return std::llround(score / kStep);
}

void add_alike(double weight, std::span<double> scores) {
  for (double& score : scores) score += weight / static_cast<double>(scores.size());
}

void add_benefits(std::span<const double> values, double weight, std::span<double> scores) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  if (sum == 0) return add_alike(weight, scores);
  for (std::size_t i = 0; i < values.size(); ++i) scores[i] += weight * (values[i] / sum);
}

/// By the least value, so that no reciprocal overflows.
void add_costs(std::span<const double> values, double weight, std::span<double> scores) {
  const double least = *std::min_element(values.begin(), values.end());
  if (least == 0) {
    const double part = weight / static_cast<double>(std::count(values.begin(), values.end(), 0.0));
    for (std::size_t i = 0; i < values.size(); ++i) scores[i] += values[i] == 0 ? part : 0;
    return;
  }
  double sum = 0;
  for (const double value : values) sum += least / value;
  const double factor = weight / sum;
  for (std::size_t i = 0; i < values.size(); ++i) scores[i] += factor * (least / values[i]);
}

}  // namespace

std::optional<std::size_t> find_unusable(std::span<const double> values) {
  const auto at = std::find_if(values.begin(), values.end(), [](double v) { return !(v >= 0 && v <= kGreatest); });
  if (at == values.end()) return std::nullopt;
  return static_cast<std::size_t>(at - values.begin());
}

void add_shares(std::span<const double> values, Direction direction, double weight, std::span<double> scores) {
  if (values.empty()) return;
  direction == Direction::benefit ? add_benefits(values, weight, scores) : add_costs(values, weight, scores);
}

std::vector<std::size_t> best_of(std::span<const double> scores, std::span<const std::string> names,
                                 std::size_t count) {
  const auto better = [&](std::size_t a, std::size_t b) {
    const std::int64_t of_a = in_steps(scores[a]);
    const std::int64_t of_b = in_steps(scores[b]);
    return of_a != of_b ? of_a > of_b : names[a] < names[b];
  };
  std::vector<std::size_t> best;  // a heap, the worst of them in front
  if (count == 0) return best;
  best.reserve(std::min(count, scores.size()) + 1);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (best.size() == count && scores[i] < scores[best.front()] - 2 * kStep) continue;
    best.push_back(i);
    std::push_heap(best.begin(), best.end(), better);
    if (best.size() <= count) continue;
    std::pop_heap(best.begin(), best.end(), better);
    best.pop_back();
  }
  std::sort_heap(best.begin(), best.end(), better);
  return best;
}

}  // namespace trb
