// The results of one run: a grow-only set. Joining two sets is union, so order, repetition and forks do no harm.
#pragma once

#include <map>
#include <vector>

#include "common/scenario/graph.hpp"
#include "proto/bodies/run.hpp"

namespace trb::scheduler {

/// A result whose signature has been checked, with the record that proves it to others.
struct HeldResult {
  SignedRecord record;
  TaskResult result;
};

bool is_final(TaskOutcome outcome);

class ResultSet {
 public:
  /// At most so many different results of one task are kept, the smallest by (attempt, content): a robot that signs
  /// endlessly fills nobody's disk, and joins still commute.
  static constexpr std::size_t kMaxPerTask = 8;

  /// True if the set has grown.
  bool add(TaskIndex task, HeldResult result);
  void join(const ResultSet& other);

  /// The result that counts: the first final one, else the latest attempt's; nullptr if there is none.
  [[nodiscard]] const HeldResult* of(TaskIndex task) const;
  [[nodiscard]] bool has_final(TaskIndex task) const;
  [[nodiscard]] bool is_skipped(TaskIndex task) const;
  [[nodiscard]] bool holds(TaskIndex task, const AttemptKey& key) const;
  /// Two different FINISHED results of one task and iteration: it may have been done twice.
  [[nodiscard]] bool finished_twice(TaskIndex task) const;
  [[nodiscard]] std::vector<bool> final_tasks(std::size_t tasks) const;
  /// The tasks that have any result, ascending.
  [[nodiscard]] std::vector<TaskIndex> tasks() const;

  bool operator==(const ResultSet& other) const;

 private:
  std::map<TaskIndex, std::vector<HeldResult>> by_task_;  ///< each list in order of (iteration, attempt, content)
};

}  // namespace trb::scheduler
