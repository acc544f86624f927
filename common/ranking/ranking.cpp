#include "common/ranking/ranking.hpp"

#include <algorithm>
#include <cmath>

#include "common/ranking/tree.hpp"

namespace trb {
namespace {

using Lists = std::vector<NodeJudgments> Person::*;

class Ranker {
 public:
  Ranker(const RankingProblem& problem, Tree tree) : problem_(problem), tree_(std::move(tree)) {}

  Result<RankingAnswer> run() && {
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      if (auto done = tree_[i].is_leaf() ? share_out(tree_[i]) : weigh_children(i); !done) return done.error();
    }
    for (std::size_t i = tree_.size(); i-- > 1;) add_to_parent(tree_[i]);
    tell_criteria();
    const std::vector<double>& scores = tree_[0].shares;
    const std::size_t top = problem_.options.top == 0 ? scores.size() : problem_.options.top;
    const auto order = best_of(scores, problem_.alternatives, top);
    for (const std::size_t index : order) tell_alternative(index);
    if (problem_.options.sensitivity) {
      answer_.sensitivity = sensitivity_of(tree_, problem_.alternatives, order.front());
    }
    return std::move(answer_);
  }

 private:
  [[nodiscard]] const std::string& name_of(const TreeNode& node) const {
    return node.criterion == nullptr ? problem_.goal : node.criterion->name;
  }

  /// What the people judged about a node; empty if nobody did.
  [[nodiscard]] std::vector<Opinion> opinions_of(const std::string& node, Lists lists) const {
    std::vector<Opinion> out;
    for (const Person& person : problem_.people) {
      for (const NodeJudgments& one : person.*lists) {
        if (one.node == node) out.push_back({person.weight, one.list, person.name});
      }
    }
    return out;
  }

  Result<std::vector<double>> judged(const std::string& node, const std::vector<std::string>& items,
                                     const std::vector<Opinion>& opinions) {
    auto found = weigh(node, items, opinions, problem_.options.method);
    if (!found) return found.error();
    const double ratio = found->consistency.cr;
    if (ratio > problem_.options.max_ratio + 1e-12) return contradiction(node, *found);
    answer_.consistency.push_back({node, found->consistency});
    return std::move(found->weights);
  }

  [[nodiscard]] Error contradiction(const std::string& node, const Priorities& found) const {
    const Judgment worst = found.worst.value_or(Judgment{});
    const std::string pair = "'" + worst.a + "' to '" + worst.b + "'";
    // Rounded up, so that the printed ratio is one that accepts the judgments.
    const double accepts = std::ceil(found.consistency.cr * 100) / 100;
    return fail(Errc::conflict,
                "judgments of '" + node + "': the consistency ratio " + short_number(found.consistency.cr) +
                    " is over " + short_number(problem_.options.max_ratio) + "; " + pair + " = " +
                    short_number(worst.times) + " hurts most",
                short_number(found.fits) + " would fit there; change it, or accept with options.max_ratio " +
                    short_number(accepts));
  }

  Status weigh_children(std::size_t index) {
    const TreeNode& node = tree_[index];
    const std::string& name = name_of(node);
    std::vector<std::string> names;
    std::size_t given = 0;
    for (const std::size_t child : node.children) {
      names.push_back(tree_[child].criterion->name);
      given += tree_[child].criterion->weight ? 1U : 0U;
    }
    const auto opinions = opinions_of(name, &Person::judgments);
    if (given != 0 && !opinions.empty()) {
      return fail(Errc::bad_value, "'" + name + "' has judgments, and below it weights are given", "keep one of both");
    }
    std::vector<double> weights(names.size(), 1.0 / static_cast<double>(names.size()));
    if (!opinions.empty()) {
      auto found = judged(name, names, opinions);
      if (!found) return found.error();
      weights = std::move(*found);
    } else if (given != 0) {
      auto found = given_weights(node);
      if (!found) return found.error();
      weights = std::move(*found);
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
      TreeNode& child = tree_[node.children[i]];
      child.local = weights[i];
      child.global = node.global * weights[i];
    }
    return Done{};
  }

  [[nodiscard]] Result<std::vector<double>> given_weights(const TreeNode& node) const {
    std::vector<double> out;
    double sum = 0;
    for (const std::size_t child : node.children) {
      const Criterion& criterion = *tree_[child].criterion;
      if (!criterion.weight) {
        return fail(Errc::missing, "'" + criterion.name + "' has no weight, but one beside it has",
                    "give all of them one, or none");
      }
      if (!(*criterion.weight >= 0 && *criterion.weight <= kGreatestJudgment)) {
        return fail(Errc::bad_value, "'" + criterion.name + "': " + short_number(*criterion.weight) + " is no weight",
                    "use a number from 0 to 1e9");
      }
      out.push_back(*criterion.weight);
      sum += out.back();
    }
    if (sum < 1e-9) {
      return fail(Errc::bad_value, "all weights below '" + name_of(node) + "' are 0", "give one of them more");
    }
    for (double& weight : out) weight /= sum;
    return out;
  }

  /// A leaf: by values, or by judgments.
  Status share_out(TreeNode& node) {
    const Criterion& leaf = *node.criterion;
    const auto opinions = opinions_of(leaf.name, &Person::alternative_judgments);
    if (!opinions.empty() && !leaf.values.empty()) {
      return fail(Errc::bad_value, "'" + leaf.name + "' has values and alternative_judgments", "keep one of both");
    }
    if (opinions.empty()) return share_values(node);
    auto found = judged(leaf.name, problem_.alternatives, opinions);
    if (!found) return found.error();
    node.shares = std::move(*found);
    return Done{};
  }

  Status share_values(TreeNode& node) const {
    const Criterion& leaf = *node.criterion;
    const std::string field = "values of '" + leaf.name + "'";
    if (leaf.values.empty()) {
      return fail(Errc::missing, "'" + leaf.name + "' has neither values nor alternative_judgments",
                  "give each alternative a value of it, or compare the alternatives in pairs");
    }
    if (leaf.values.size() != problem_.alternatives.size()) {
      return fail(Errc::bad_value,
                  field + ": " + std::to_string(leaf.values.size()) + " for " +
                      std::to_string(problem_.alternatives.size()) + " alternatives",
                  "give each alternative one");
    }
    if (const auto bad = find_unusable(leaf.values)) {
      const double value = leaf.values[*bad];
      const std::string& id = problem_.alternatives[*bad];
      if (std::isnan(value)) {
        return fail(Errc::missing, field + ": '" + id + "' has none", "measure it, or leave '" + id + "' out");
      }
      return fail(Errc::bad_value, field + ": that of '" + id + "' is " + short_number(value),
                  "use numbers from 0 to 1e300: count from the other end, or from the least that is possible");
    }
    node.shares.assign(leaf.values.size(), 0);
    add_shares(leaf.values, leaf.direction, 1, node.shares);
    return Done{};
  }

  void add_to_parent(const TreeNode& node) {
    std::vector<double>& sum = tree_[node.parent].shares;
    sum.resize(node.shares.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += node.local * node.shares[i];
  }

  void tell_criteria() {
    for (std::size_t i = 1; i < tree_.size(); ++i) {
      const TreeNode& node = tree_[i];
      answer_.criteria.push_back({node.criterion->name, node.local, node.global, node.level});
      if (node.is_leaf()) answer_.leaves.push_back(node.criterion->name);
    }
  }

  void tell_alternative(std::size_t index) {
    RankedAlternative out{problem_.alternatives[index], tree_[0].shares[index]};
    for (const TreeNode& node : tree_) {
      if (node.is_leaf()) out.contributions.push_back(node.global * node.shares[index]);
    }
    answer_.ranking.push_back(std::move(out));
  }

  const RankingProblem& problem_;
  Tree tree_;
  RankingAnswer answer_;
};

}  // namespace

Result<RankingAnswer> rank(const RankingProblem& problem) {
  auto tree = lay_out(problem);
  if (!tree) return tree.error();
  return Ranker(problem, std::move(*tree)).run();
}

std::string sensitivity_text(const RankingAnswer& answer) {
  if (answer.ranking.empty()) return "";
  const std::string& winner = answer.ranking.front().id;
  const Sensitivity* of = nullptr;
  const WinnerChange* nearest = nullptr;
  double least = HUGE_VAL;
  for (const Sensitivity& one : answer.sensitivity) {
    for (const WinnerChange& change : one.changes) {
      const double way = std::abs(change.weight - one.weight);
      if (way >= least) continue;
      least = way;
      of = &one;
      nearest = &change;
    }
  }
  if (nearest == nullptr) return "'" + winner + "' stays first whatever any one criterion weighs.";
  const bool less = nearest->weight < of->weight;
  return "'" + winner + "' stays first unless '" + of->criterion + "' weighs " + (less ? "less" : "more") + " than " +
         short_number(nearest->weight) + " among its siblings (now " + short_number(of->weight) + "): then '" +
         nearest->winner + "' is.";
}

}  // namespace trb
