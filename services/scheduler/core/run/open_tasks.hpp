// Which tasks of a run this node can do something about now, as far as it knows. All lists ascend.
#pragma once

#include <vector>

#include "services/scheduler/core/run/deliveries.hpp"
#include "services/scheduler/core/run/facts.hpp"
#include "services/scheduler/core/run/pending_work.hpp"
#include "services/scheduler/core/run/reports.hpp"

namespace trb::scheduler {

class OpenTasks {
 public:
  struct Parts {
    const RunDefinition& definition;
    const Epochs& epochs;
    const Facts& facts;
    const Reports& reports;
    const Deliveries& deliveries;
    const PendingWork& work;
  };
  /// All parts must outlive it.
  explicit OpenTasks(const Parts& parts) : run_(parts) {}

  /// This node's tasks that could begin: not begun yet, all predecessors' final results held.
  [[nodiscard]] std::vector<TaskIndex> startable() const { return own_tasks_that(Fate::goes); }
  /// Tasks for which the decider's node, this one, has to report that a robot is wanted.
  [[nodiscard]] std::vector<TaskIndex> to_bind() const { return own_tasks_that(Fate::binds); }
  /// This node's tasks that are to be SKIPPED, and are not yet.
  [[nodiscard]] std::vector<TaskIndex> skippable() const;
  /// The tasks whose conditions this node has to evaluate now.
  [[nodiscard]] std::vector<TaskIndex> to_choose() const;
  /// This node's tasks that it was asked to give back and has not begun.
  [[nodiscard]] std::vector<TaskIndex> releasable() const;
  /// Nothing stands before them on this node, and they are not known to have begun. Of tasks of other nodes only the
  /// judge knows, and who owes their batons.
  [[nodiscard]] std::vector<TaskIndex> due() const;
  /// Tasks of the judge's view that are behind nothing but their condition, which another node evaluates.
  [[nodiscard]] std::vector<TaskIndex> choosing_elsewhere() const;
  /// Results that this node's next tasks need, that are said to be final and are not held.
  [[nodiscard]] std::vector<TaskIndex> missing_results(const std::vector<bool>& known_final) const;

 private:
  [[nodiscard]] std::vector<TaskIndex> own_tasks_that(Fate fate) const;
  [[nodiscard]] bool is_due(TaskIndex task) const;
  [[nodiscard]] bool may_skip() const;

  Parts run_;
};

}  // namespace trb::scheduler
