// A ranking problem laid out: checked, its criteria flat, parents before children. Internal to common/ranking.
#pragma once

#include <string>
#include <vector>

#include "common/ranking/ranking.hpp"

namespace trb {

struct TreeNode {
  const Criterion* criterion = nullptr;  ///< nullptr: the goal
  std::size_t parent = 0;
  std::size_t level = 0;
  std::vector<std::size_t> children = {};
  double local = 1;
  double global = 1;
  std::vector<double> shares = {};  ///< each alternative's share below this node; sum 1

  [[nodiscard]] bool is_leaf() const { return criterion != nullptr && children.empty(); }
};

/// The goal first.
using Tree = std::vector<TreeNode>;

/// Checks everything but judgments and values. The tree points into the problem.
Result<Tree> lay_out(const RankingProblem& problem);

/// For each criterion; the tree has its weights and shares, `winner` is the index of the best alternative.
std::vector<Sensitivity> sensitivity_of(const Tree& tree, const std::vector<std::string>& alternatives,
                                        std::size_t winner);

}  // namespace trb
