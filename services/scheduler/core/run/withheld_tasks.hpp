// This node's tasks of a run that it does not begin any more: the decider wants them back, they cannot be begun,
// or nobody would believe how they end.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/scenario/graph.hpp"

namespace trb::scheduler {

class WithheldTasks {
 public:
  /// The decider asks for them. `stop`: one that runs is to stop.
  void give_back(const std::vector<TaskIndex>& tasks, bool stop = false);
  [[nodiscard]] const std::set<TaskIndex>& asked_back() const { return asked_back_; }
  [[nodiscard]] bool is_asked_back(TaskIndex task) const { return asked_back_.contains(task); }
  /// It is asked back, and is to stop if it runs.
  [[nodiscard]] bool is_to_stop(TaskIndex task) const { return to_stop_.contains(task); }

  /// It fails without an attempt. `why`: for a person.
  void fail(TaskIndex task, std::string why) {
    failing_[task] = std::move(why);
    ++changes_;
  }
  [[nodiscard]] const std::map<TaskIndex, std::string>& failing() const { return failing_; }
  [[nodiscard]] bool is_failing(TaskIndex task) const { return failing_.contains(task); }
  /// Its result is known.
  void drop_failing(TaskIndex task) { changes_ += failing_.erase(task); }

  /// All of them, for good: what this node signs is not believed in this run. True if that is new.
  bool withhold_all();
  [[nodiscard]] bool are_all() const { return all_; }

  [[nodiscard]] bool contains(TaskIndex task) const { return all_ || is_asked_back(task) || is_failing(task); }
  /// A decision has ruled on it: it begins anew.
  void drop(TaskIndex task);
  /// Rises with every change.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

 private:
  std::set<TaskIndex> asked_back_;
  std::set<TaskIndex> to_stop_;
  std::map<TaskIndex, std::string> failing_;
  bool all_ = false;
  std::uint64_t changes_ = 0;
};

}  // namespace trb::scheduler
