// Ranks alternatives by criteria (the analytic hierarchy process), and explains the answer.
//
// Criteria form a tree below the goal. Below each node the children's weights come from pairwise judgments, or are
// given, or are alike. The alternatives' shares of a leaf come from measured values or from pairwise judgments. A score
// is the sum over the leaves of weight x share: Saaty's distributive mode.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/ranking/pairwise.hpp"
#include "common/ranking/shares.hpp"

namespace trb {

constexpr std::size_t kMostLevels = 10;
constexpr std::size_t kMostChildren = 64;
constexpr std::size_t kMostCriteria = 256;
constexpr std::size_t kMostAlternatives = 20'000;
constexpr std::size_t kMostValues = 200'000;  ///< leaf criteria x alternatives
constexpr std::size_t kMostPeople = 100;
constexpr std::size_t kLongestName = 128;

struct Criterion {
  std::string name;  ///< the tree's and the goal's names differ
  std::vector<Criterion> children = {};
  std::optional<double> weight = {};  ///< given instead of judged: relative to its siblings, which must all have one
                                      ///< then
  // Of a leaf with measured values:
  Direction direction = Direction::benefit;
  std::string unit = {};
  std::vector<double> values = {};  ///< one for each alternative, in their order; NaN: missing
};

/// The judgments of one node: of the goal or a criterion between its children, of a leaf between the alternatives.
struct NodeJudgments {
  std::string node;
  std::vector<Judgment> list;
};

/// Judgments about a leaf say which alternative is better, whatever its direction.
struct Person {
  std::string name = {};
  double weight = 1;
  std::vector<NodeJudgments> judgments = {};
  std::vector<NodeJudgments> alternative_judgments = {};
};

struct RankingOptions {
  WeightMethod method = WeightMethod::eigenvector;
  double max_ratio = 0.10;  ///< a higher consistency ratio is refused (Saaty's tenth)
  std::size_t top = 0;      ///< how many of the best are returned; 0: all
  bool sensitivity = true;
};

struct RankingProblem {
  std::string goal;
  std::vector<Criterion> criteria;
  std::vector<std::string> alternatives;  ///< their ids
  std::vector<Person> people = {};        ///< empty if no node is judged
  RankingOptions options = {};
};

struct CriterionWeight {
  std::string name;
  double local = 0;   ///< among its siblings
  double global = 0;  ///< of the whole
  std::size_t level = 1;
};

struct NodeConsistency {
  std::string node;
  Consistency of;
};

struct RankedAlternative {
  std::string id;
  double score = 0;                        ///< the sum over all alternatives is 1
  std::vector<double> contributions = {};  ///< of each leaf, in the order of RankingAnswer::leaves; their sum is the
                                           ///< score
};

/// Another alternative wins if a criterion's local weight passes this value, coming from its present one.
struct WinnerChange {
  double weight = 0;
  std::string winner;
};

/// What happens to the winner if one criterion's local weight goes from 0 to 1 and its siblings' are scaled in
/// proportion (from all 0: alike). Ascending; the nearest 16 on each side.
struct Sensitivity {
  std::string criterion;
  double weight = 0;  ///< the present one
  std::vector<WinnerChange> changes = {};
};

struct RankingAnswer {
  std::vector<CriterionWeight> criteria;     ///< parents before children, as given
  std::vector<std::string> leaves;           ///< as given
  std::vector<NodeConsistency> consistency;  ///< of each judged node
  std::vector<RankedAlternative> ranking;    ///< best first, equal ones by id
  std::vector<Sensitivity> sensitivity;      ///< of each criterion
};

/// Errors: those of weigh(); missing (no goal, criterion, alternative, value, weight), duplicate (a name, an id, a
/// person's node), too_large, unknown_key (judgments of an unknown node), bad_value (values as well as judgments, a
/// negative value or weight), conflict (a consistency ratio above max_ratio: with the worst judgment, and the value
/// that would fit).
Result<RankingAnswer> rank(const RankingProblem& problem);

/// One sentence: how far the winner is from losing.
std::string sensitivity_text(const RankingAnswer& answer);

}  // namespace trb
