// Weights from pairwise judgments (Saaty's analytic hierarchy process), and how well the judgments agree.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "proto/field.hpp"

namespace trb {

enum class WeightMethod : std::uint8_t { eigenvector, geometric_mean };
constexpr auto enum_names(WeightMethod) {
  return std::to_array<std::string_view>({"eigenvector", "geometric_mean"});
}

/// The most items that can be judged in pairs: Saaty's random indices end there.
constexpr std::size_t kMostJudged = 15;
/// The greatest judgment; its reciprocal is the least: beyond that, sums overflow.
constexpr double kGreatestJudgment = 1e9;

/// `a` counts `times` as much as `b`, a positive number; Saaty's scale has 1 (alike), 3, 5, 7 and 9 (extremely more).
struct Judgment {
  std::string a;
  std::string b;
  double times = 1;
};

/// What one person judged, and how much that person's judgments count: from 1e-6 to 1e6.
struct Opinion {
  double weight = 1;
  std::span<const Judgment> judgments;
  std::string who = {};  ///< for an error's text; may be empty
};

/// lambda_max: the principal eigenvalue, at least n. ci = (lambda_max - n) / (n - 1). cr = ci / the random index of n;
/// 0 for n of 1 and 2, where nothing can disagree.
struct Consistency {
  double lambda_max = 1;
  double ci = 0;
  double cr = 0;
};

struct Priorities {
  std::vector<double> weights;  ///< of the items in their order; sum 1
  Consistency consistency;
  std::optional<Judgment> worst;  ///< the judgment furthest from the weights, if there is any
  double fits = 1;                ///< the value of `worst` that would agree with the weights
};

/// The weights of `items` from all people's judgments: combined by the weighted geometric mean (Aczel and Saaty 1983),
/// for each pair over those who judged it. A reciprocal is implied, or may be given as well (within 1 %: people round).
/// Missing judgments are filled in from the weights: Harker's method (1987) for the eigenvector, logarithmic least
/// squares for the geometric mean. lambda_max is that of Harker's matrix with either method; a filled-in judgment
/// agrees with the weights, so fewer judgments give a lower ratio. Errors, each names `node`: too_large (more than
/// kMostJudged items), bad_value (not positive, too large, of an item with itself, both directions that do not fit),
/// unknown_key (no such item), duplicate, missing (no chain of judgments links some items: the groups are named),
/// conflict (too contradictory for any weights).
Result<Priorities> weigh(const std::string& node, const std::vector<std::string>& items,
                         const std::vector<Opinion>& opinions, WeightMethod method);

/// A number for an error message, "0.33".
std::string short_number(double number);

/// "'a', 'b', 'c'", the first 8 of them.
std::string quoted_names(const std::vector<std::string>& names);

}  // namespace trb
