// What this node requests from other members of a run, until it comes.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/scenario/graph.hpp"
#include "services/scheduler/core/run/pending_deliveries.hpp"

namespace trb::scheduler {

class PendingRequests {
 public:
  /// A result that this node's next tasks need, and which `giver` should hold. The first giver stays.
  void need_result(TaskIndex task, const std::string& giver) { results_.try_emplace(task, Need{giver}); }
  void drop_result(TaskIndex task) { results_.erase(task); }
  /// That giver does not hold what it was asked for.
  void drop_results_of(const std::string& giver);
  void drop_results() { results_.clear(); }
  [[nodiscard]] bool needs_results() const { return !results_.empty(); }
  /// It has answered that it has no result of the task.
  [[nodiscard]] bool holds_none(const std::string& giver, TaskIndex task) const {
    return none_.contains({giver, task});
  }
  /// The results to be requested now, by giver; they count as requested.
  std::map<std::string, std::vector<TaskIndex>> take_due_results(MonotonicTime now);

  /// The decisions on the run are requested from a node.
  void await_decisions(const std::string& node) { decisions_.insert(node); }
  /// Its answer has come; false: none was requested.
  bool settle_decisions(const std::string& node) { return decisions_.erase(node) > 0; }

  /// True if it is time to request from the judge whether the run is over; begins to count at the first call.
  bool end_is_due(MonotonicTime now) { return end_.due(now); }
  void drop_end() { end_.reset(); }

  void restart();
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  struct Need {
    std::string giver;
    ResendTimer timer = resend_timer();
  };
  std::map<TaskIndex, Need> results_;
  std::set<std::pair<std::string, TaskIndex>> none_;
  std::set<std::string> decisions_;
  Pace end_;
};

}  // namespace trb::scheduler
