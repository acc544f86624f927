// Which tasks of a run this node can do something about now, as far as it knows. All lists ascend.
#pragma once

#include <cstdint>
#include <optional>
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
  [[nodiscard]] std::vector<TaskIndex> startable() const { return ready().startable; }
  /// Tasks for which the decider's node, this one, has to report that a robot is wanted.
  [[nodiscard]] std::vector<TaskIndex> to_bind() const { return ready().to_bind; }
  /// This node's tasks that are to be SKIPPED, and are not yet.
  [[nodiscard]] std::vector<TaskIndex> skippable() const { return ready().skippable; }
  /// The tasks whose conditions this node has to evaluate now.
  [[nodiscard]] std::vector<TaskIndex> to_choose() const { return ready().to_choose; }
  /// All of this node's tasks are final.
  [[nodiscard]] bool own_are_final() const { return ready().own_are_final; }
  /// One of this node's tasks has a result, and is not final.
  [[nodiscard]] bool own_has_failed() const { return ready().own_has_failed; }
  /// This node's tasks that it was asked to give back and has not begun.
  [[nodiscard]] std::vector<TaskIndex> releasable() const;
  /// Nothing stands before them on this node, they are not known to have begun, and no pause before another try keeps
  /// them back. Of tasks of other nodes only the
  /// judge knows, and who owes their batons.
  [[nodiscard]] std::vector<TaskIndex> due() const;
  /// Tasks of the judge's view that are behind nothing but their condition, which another node evaluates.
  [[nodiscard]] std::vector<TaskIndex> choosing_elsewhere() const;
  /// Results that this node's next tasks need, that are said to be final and are not held.
  [[nodiscard]] std::vector<TaskIndex> missing_results(const std::vector<bool>& known_final) const;

 private:
  /// What every step asks of every run. It is worked out anew only when it has changed.
  struct Ready {
    std::vector<TaskIndex> startable;
    std::vector<TaskIndex> to_bind;
    std::vector<TaskIndex> skippable;
    std::vector<TaskIndex> to_choose;
    bool own_are_final = true;
    bool own_has_failed = false;
  };
  /// All that Ready follows from.
  struct Version {
    std::uint64_t facts = 0;
    std::uint32_t epoch = 0;
    std::uint64_t withheld = 0;
    bool operator==(const Version&) const = default;
  };
  [[nodiscard]] const Ready& ready() const;
  void sort_in(TaskIndex own, Ready& out) const;
  [[nodiscard]] bool is_due(TaskIndex task) const;
  [[nodiscard]] bool may_skip() const;
  [[nodiscard]] bool has_to_choose(TaskIndex task) const;

  Parts run_;
  mutable std::optional<Version> ready_of_;
  mutable Ready ready_;
};

}  // namespace trb::scheduler
