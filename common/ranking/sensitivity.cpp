// Where the winner changes as one criterion's weight does.
#include <algorithm>
#include <cmath>

#include "common/ranking/tree.hpp"

namespace trb {
namespace {

constexpr std::size_t kMostChanges = 16;
constexpr double kSame = 1e-12;

/// The score of each alternative over the criterion's local weight t: base + slope x t.
struct Lines {
  std::vector<double> base;
  std::vector<double> slope;
};

/// What its siblings contribute without the criterion, scaled to a weight of 1.
std::vector<double> rest_of(const Tree& tree, std::size_t index) {
  const TreeNode& parent = tree[tree[index].parent];
  double weight = 0;
  for (const std::size_t child : parent.children) weight += child == index ? 0 : tree[child].local;
  const double alike = 1.0 / static_cast<double>(parent.children.size() - 1);
  std::vector<double> out(parent.shares.size());
  for (const std::size_t child : parent.children) {
    if (child == index) continue;
    const double part = weight > kSame ? tree[child].local / weight : alike;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += part * tree[child].shares[i];
  }
  return out;
}

Lines lines_of(const Tree& tree, std::size_t index) {
  const TreeNode& node = tree[index];
  const TreeNode& parent = tree[node.parent];
  const std::vector<double> rest = rest_of(tree, index);
  Lines out;
  out.base.resize(rest.size());
  out.slope.resize(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    out.base[i] = tree[0].shares[i] + parent.global * (rest[i] - parent.shares[i]);
    out.slope[i] = parent.global * (node.shares[i] - rest[i]);
  }
  return out;
}

struct Step {
  double at;
  std::size_t winner;
};

/// The first to overtake `winner` from `at` on; `sign` -1 looks downwards.
Step next_step(const Lines& lines, const std::vector<std::string>& ids, Step from, double sign) {
  Step best{HUGE_VAL, from.winner};
  for (std::size_t i = 0; i < lines.base.size(); ++i) {
    const double gain = sign * (lines.slope[i] - lines.slope[from.winner]);
    if (gain <= kSame) continue;
    const double gap = lines.base[from.winner] - lines.base[i] + (lines.slope[from.winner] - lines.slope[i]) * from.at;
    const double way = std::max(0.0, gap / gain);
    if (way > best.at + kSame) continue;
    const double more = sign * (lines.slope[i] - lines.slope[best.winner]);
    const bool steeper = more > kSame || (more >= -kSame && ids[i] < ids[best.winner]);
    if (way < best.at - kSame || steeper) best = {way, i};
  }
  best.at = from.at + sign * best.at;
  return best;
}

/// Up to 0 or 1. An alternative that wins at a single point is skipped.
std::vector<WinnerChange> walk(const Lines& lines, const std::vector<std::string>& ids, Step from, double sign) {
  constexpr double kPoint = 1e-9;
  const double end = sign > 0 ? 1 - kPoint : kPoint;
  std::vector<WinnerChange> out;
  for (;;) {
    const Step next = next_step(lines, ids, from, sign);
    if (next.winner == from.winner || sign * (next.at - end) >= 0) return out;
    if (!out.empty() && std::abs(next.at - from.at) < kPoint) out.pop_back();
    if (out.size() == kMostChanges) return out;
    out.push_back({next.at, ids[next.winner]});
    from = next;
  }
}

}  // namespace

std::vector<Sensitivity> sensitivity_of(const Tree& tree, const std::vector<std::string>& alternatives,
                                        std::size_t winner) {
  std::vector<Sensitivity> out;
  for (std::size_t index = 1; index < tree.size(); ++index) {
    const TreeNode& node = tree[index];
    Sensitivity one{node.criterion->name, node.local};
    if (tree[node.parent].children.size() > 1) {
      const Lines lines = lines_of(tree, index);
      one.changes = walk(lines, alternatives, {node.local, winner}, -1);
      std::reverse(one.changes.begin(), one.changes.end());
      for (WinnerChange& change : walk(lines, alternatives, {node.local, winner}, 1)) {
        one.changes.push_back(std::move(change));
      }
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace trb
