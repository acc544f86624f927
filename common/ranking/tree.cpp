#include "common/ranking/tree.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace trb {
namespace {

Status check_name(const std::string& what, const std::string& name) {
  if (name.empty()) return fail(Errc::missing, what + " has no name", "give it one");
  if (name.size() <= kLongestName) return Done{};
  return fail(Errc::too_large, what + " has a name of " + std::to_string(name.size()) + " bytes",
              "keep it to " + std::to_string(kLongestName));
}

Status check_count(const std::string& what, std::size_t count, std::size_t most) {
  if (count <= most) return Done{};
  return fail(Errc::too_large, what + ": " + std::to_string(count) + " are too many",
              "keep it to " + std::to_string(most));
}

class Layout {
 public:
  explicit Layout(const RankingProblem& problem) : problem_(problem) {}

  Result<Tree> run() && {
    if (auto good = check_name("goal", problem_.goal); !good) return good.error();
    names_.insert(problem_.goal);
    tree_.push_back({});
    if (problem_.criteria.empty()) {
      return fail(Errc::missing, "criteria: there are none", R"(add one, for example {"name": "battery"})");
    }
    if (auto good = add_children(0, problem_.goal, problem_.criteria); !good) return good.error();
    return std::move(tree_);
  }

 private:
  Status add_children(std::size_t parent, const std::string& name, const std::vector<Criterion>& children) {
    const std::string what = "criteria of '" + name + "'";
    if (auto good = check_count(what, children.size(), kMostChildren); !good) return good;
    if (tree_[parent].level == kMostLevels) {
      return fail(Errc::too_large, what + ": nested deeper than " + std::to_string(kMostLevels) + " levels",
                  "flatten the tree");
    }
    for (const Criterion& child : children) {
      if (auto good = add(parent, child); !good) return good;
    }
    return Done{};
  }

  Status add(std::size_t parent, const Criterion& criterion) {
    if (auto good = check_name("a criterion", criterion.name); !good) return good;
    if (!names_.insert(criterion.name).second) {
      return fail(Errc::duplicate, "criteria: the name '" + criterion.name + "' occurs twice, or is the goal's",
                  "give each criterion a name of its own");
    }
    if (auto good = check_count("criteria", tree_.size(), kMostCriteria); !good) return good;
    if (!criterion.children.empty() && !criterion.values.empty()) {
      return fail(Errc::bad_value, "'" + criterion.name + "' has values, but also criteria below it",
                  "give the values to those");
    }
    const std::size_t index = tree_.size();
    TreeNode node;
    node.criterion = &criterion;
    node.parent = parent;
    node.level = tree_[parent].level + 1;
    tree_.push_back(std::move(node));
    tree_[parent].children.push_back(index);
    if (criterion.children.empty()) return Done{};
    return add_children(index, criterion.name, criterion.children);
  }

  const RankingProblem& problem_;
  Tree tree_;
  std::set<std::string> names_;
};

Status check_alternatives(const RankingProblem& problem) {
  if (problem.alternatives.empty()) {
    return fail(Errc::missing, "alternatives: there are none", R"(add one, for example {"id": "pioneer1"})");
  }
  if (auto good = check_count("alternatives", problem.alternatives.size(), kMostAlternatives); !good) return good;
  std::vector<std::string_view> ids(problem.alternatives.begin(), problem.alternatives.end());
  std::sort(ids.begin(), ids.end());
  for (const std::string& id : problem.alternatives) {
    if (auto good = check_name("an alternative", id); !good) return good;
  }
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice == ids.end()) return Done{};
  return fail(Errc::duplicate, "alternatives: the id '" + std::string(*twice) + "' occurs twice", "keep one of them");
}

/// Each list must be for a different node, and for one that has something to judge.
Status check_lists(const std::vector<NodeJudgments>& lists, const std::string& key,
                   const std::vector<std::string>& allowed, const std::string& hint) {
  std::set<std::string> seen;
  for (const NodeJudgments& one : lists) {
    if (!seen.insert(one.node).second) {
      return fail(Errc::duplicate, key + ": '" + one.node + "' has two lists", "make one of them");
    }
    if (std::find(allowed.begin(), allowed.end(), one.node) == allowed.end()) {
      return fail(Errc::unknown_key, key + ": '" + one.node + "' " + hint, "use one of " + quoted_names(allowed));
    }
  }
  return Done{};
}

Status check_people(const RankingProblem& problem, const Tree& tree) {
  if (auto good = check_count("people", problem.people.size(), kMostPeople); !good) return good;
  std::vector<std::string> parents{problem.goal};
  std::vector<std::string> leaves;
  for (std::size_t i = 1; i < tree.size(); ++i) {
    (tree[i].is_leaf() ? leaves : parents).push_back(tree[i].criterion->name);
  }
  for (const Person& person : problem.people) {
    auto good =
        check_lists(person.judgments, "judgments", parents, "is neither the goal nor a criterion with children");
    if (!good) return good;
    good =
        check_lists(person.alternative_judgments, "alternative_judgments", leaves, "is no criterion without children");
    if (!good) return good;
  }
  return Done{};
}

}  // namespace

Result<Tree> lay_out(const RankingProblem& problem) {
  const double ratio = problem.options.max_ratio;
  if (!(ratio >= 0 && std::isfinite(ratio))) {
    return fail(Errc::bad_value, "options.max_ratio: " + short_number(ratio) + " is no ratio",
                "use 0.1, Saaty's bound");
  }
  auto tree = Layout(problem).run();
  if (!tree) return tree;
  if (auto good = check_alternatives(problem); !good) return good.error();
  if (auto good = check_people(problem, *tree); !good) return good.error();
  const auto leaves = static_cast<std::size_t>(
      std::count_if(tree->begin(), tree->end(), [](const TreeNode& node) { return node.is_leaf(); }));
  const std::string what = "alternatives x criteria without children";
  if (auto good = check_count(what, leaves * problem.alternatives.size(), kMostValues); !good) return good.error();
  return tree;
}

}  // namespace trb
