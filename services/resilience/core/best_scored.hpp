// The best of many scores, without sorting them all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

struct Scored {
  RobotNumber robot = 0;
  double score = 0;
  bool operator==(const Scored&) const = default;
};

/// Keeps so many of the robots that are added: those with the highest scores, of equals those with the smaller numbers.
class BestScored {
 public:
  explicit BestScored(std::size_t most) : most_(most) {}

  void add(const Scored& scored) {
    if (most_ == 0 || (best_.size() == most_ && !better(scored, best_.front()))) return;
    best_.push_back(scored);
    std::push_heap(best_.begin(), best_.end(), better);
    if (best_.size() <= most_) return;
    std::pop_heap(best_.begin(), best_.end(), better);
    best_.pop_back();
  }
  /// Best first; none are kept any more.
  [[nodiscard]] std::vector<Scored> take() {
    std::sort_heap(best_.begin(), best_.end(), better);
    return std::exchange(best_, {});
  }

 private:
  static bool better(const Scored& a, const Scored& b) {
    return a.score != b.score ? a.score > b.score : a.robot < b.robot;
  }

  std::size_t most_;
  std::vector<Scored> best_;  ///< a heap, the worst on top
};

}  // namespace trb::resilience
