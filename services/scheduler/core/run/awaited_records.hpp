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

class AwaitedRecords {
 public:
  /// A result that this node's next tasks need, and which `giver` should hold. The first giver is asked, unless the
  /// run's judge should hold it. A member that says so and never answers keeps nobody from asking the others who do:
  /// after 5 questions in vain it is the next one's turn.
  void need_result(TaskIndex task, const std::string& giver, const std::string& judge);
  void drop_result(TaskIndex task) { results_.erase(task); }
  void drop_results() { results_.clear(); }
  /// The giver has answered with a result of the task, final or not: it holds no other.
  void settle_result(TaskIndex task, const std::string& giver);
  /// It has answered without any result: it holds none of the tasks that each request had which this may answer.
  void settle_without_result(const std::string& giver, MonotonicTime now);
  [[nodiscard]] bool needs_results() const { return !results_.empty(); }
  /// What it holds of the task, perhaps nothing, has come.
  [[nodiscard]] bool has_answered(const std::string& giver, TaskIndex task) const {
    return answered_.contains({giver, task});
  }
  /// The results to be requested now, by giver; they count as requested. With one that is due all that are needed of
  /// its giver.
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
    std::vector<std::string> others{};  ///< who should hold it, too: in the order in which they are asked
    ResendTimer timer = resend_timer();
    /// From then on no request without this task can be answered any more; empty: it has not been requested.
    std::optional<MonotonicTime> in_all_since{};
  };
  static void ask_next(Need& need, bool again);
  void settle(std::map<TaskIndex, Need>::iterator need);

  std::map<TaskIndex, Need> results_;
  std::map<std::string, MonotonicTime> requested_;  ///< the last request for results, by giver
  std::set<std::pair<std::string, TaskIndex>> answered_;
  std::set<std::string> decisions_;
  Pace end_;
};

}  // namespace trb::scheduler
