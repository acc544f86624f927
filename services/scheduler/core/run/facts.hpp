// What is journaled of a run's tasks: start records, results, choices; and what follows from them in this epoch. Facts
// are only added, in any order.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/time.hpp"
#include "services/scheduler/core/journal_records.hpp"
#include "services/scheduler/core/run/epochs.hpp"
#include "services/scheduler/core/run/results.hpp"

namespace trb::scheduler {

/// A choice whose signature has been checked, with the record that proves it to others.
struct HeldChoice {
  SignedRecord record;
  Choice choice;
};

/// What is to become of a task whose predecessors are all final. `binds`: it goes once it has a robot.
enum class Fate : std::uint8_t { undecided = 0, goes, binds, skipped };

class Facts {
 public:
  /// Both must outlive it.
  Facts(const RunDefinition& definition, const Epochs& epochs);
  Facts(const Facts&) = delete;
  Facts& operator=(const Facts&) = delete;

  /// Of a result that has been checked: true if it was new.
  bool add(TaskIndex task, HeldResult held);
  /// Of a choice that has been checked: the tasks on which it is the first one. What is chosen stays chosen.
  std::vector<TaskIndex> add(const std::shared_ptr<const HeldChoice>& held);
  void add(TaskIndex task, const JournalStart& start);
  /// Rises with every fact.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  [[nodiscard]] const ResultSet& results() const { return results_; }
  /// The choice on a task's condition, or nullptr.
  [[nodiscard]] const HeldChoice* choice_on(TaskIndex task) const;
  /// The result of a task as things stand: nullptr if there is none, or if what ended so is void, because a decision or
  /// its robot's retries have the task done again.
  [[nodiscard]] const HeldResult* current(TaskIndex task) const;
  /// The attempt that is to be made next.
  [[nodiscard]] std::uint32_t next_attempt(TaskIndex task) const;
  /// How long the robot waits before it tries a task again.
  [[nodiscard]] Duration retry_pause(TaskIndex task) const;
  /// When its robot tries it again, after a failure that is not the last one; nothing: it does not.
  [[nodiscard]] std::optional<UtcTime> tried_again_at(TaskIndex task) const;
  /// There is a start record of the next attempt.
  [[nodiscard]] bool has_begun(TaskIndex task) const;
  /// A start record without a result: nobody has reported yet how it ended.
  [[nodiscard]] const JournalStart* open_start() const;
  /// That attempt was begun here, and its result is not held.
  [[nodiscard]] bool awaits_result(TaskIndex task, const AttemptKey& key) const;

  [[nodiscard]] bool all_final() const { return open_ == 0; }
  [[nodiscard]] bool all_before_final(TaskIndex task) const { return before_[task].open == 0; }
  /// There are predecessors, and every one is SKIPPED and takes what follows it along.
  [[nodiscard]] bool all_before_skipped(TaskIndex task) const;
  /// Those before it that this node executes are final.
  [[nodiscard]] bool own_before_final(TaskIndex task) const;
  [[nodiscard]] Fate fate_of(TaskIndex task) const;
  /// It is due, and the decider's node has reported that it has no robot.
  [[nodiscard]] bool wants_robot(TaskIndex task) const;
  /// The tasks that wait for a decision: failed, retriable, interrupted. What follows them waits, other branches go on.
  [[nodiscard]] std::vector<TaskIndex> problems() const;
  /// The task whose failure ends the run: its robot orders the abort, and the judge, if the robot is gone by then.
  [[nodiscard]] std::optional<TaskIndex> ending_task() const;

 private:
  /// Its robot will try it again by itself.
  [[nodiscard]] bool tries_again(TaskIndex task, const TaskResult& result) const;
  /// It is SKIPPED, and so is what follows nothing else.
  [[nodiscard]] bool takes_along(TaskIndex task) const;
  [[nodiscard]] std::optional<TaskIndex> find_ending_task() const;

  /// Counted as results come: every step asks, and a task may have hundreds of predecessors.
  struct Before {
    std::size_t open = 0;   ///< predecessors that are not final
    std::size_t going = 0;  ///< predecessors that do not take along what follows them
  };

  const RunDefinition& definition_;
  const Epochs& epochs_;
  ResultSet results_;
  std::map<TaskIndex, std::shared_ptr<const HeldChoice>> choices_;
  std::map<TaskIndex, JournalStart> starts_;
  std::vector<Before> before_;
  std::size_t open_ = 0;  ///< tasks that are not final
  std::uint64_t changes_ = 0;
  /// Of which changes and epoch the ending task is known.
  mutable std::optional<std::pair<std::uint64_t, std::uint32_t>> ending_of_;
  mutable std::optional<TaskIndex> ending_;
};

}  // namespace trb::scheduler
