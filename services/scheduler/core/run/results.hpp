// The results of one run: a grow-only set. Joining two sets is union, so order, repetition and forks do no harm.
#pragma once

#include <map>
#include <string>
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
  /// At most so many different results of one attempt are kept: FINISHED before SKIPPED before the others, so that what
  /// is final stays final; then those of the later epoch; then the smaller by content. Joins so commute, and a robot
  /// that signs endlessly fills nobody's memory. Attempts are bounded by kMaxAttempts.
  static constexpr std::size_t kMaxPerAttempt = 2;

  /// What one robot's results of one run may take: more of it is not received, and its own node leaves the data out.
  static constexpr std::size_t kMostBytes = 4U << 20U;

  /// False: the set has it, or of its attempt as many as are kept and are preferred to it.
  [[nodiscard]] bool grows_by(TaskIndex task, const HeldResult& result) const;
  /// True if the set has grown.
  bool add(TaskIndex task, HeldResult result);
  void join(const ResultSet& other);

  /// The result that counts: the first FINISHED one, else the first SKIPPED one (what was done was not left out,
  /// whoever thought so), else the latest epoch's latest attempt's; nullptr if there is none.
  [[nodiscard]] const HeldResult* of(TaskIndex task) const;
  /// What proves to others how a task ended: the result that counts and, if it was done twice, another FINISHED one,
  /// that robot's rather than a third's; none if there is no result.
  [[nodiscard]] std::vector<const HeldResult*> proof_of(TaskIndex task, const std::string& robot) const;
  [[nodiscard]] bool has_final(TaskIndex task) const;
  [[nodiscard]] bool is_skipped(TaskIndex task) const;
  /// True if there is that robot's result of the attempt: who was replaced may have counted on.
  [[nodiscard]] bool holds(TaskIndex task, const AttemptKey& key, const std::string& robot) const;
  /// The last attempt of which there is that robot's result of that epoch or a later one; 0: none.
  [[nodiscard]] std::uint32_t last_attempt(TaskIndex task, const std::string& robot, std::uint32_t epoch) const;
  /// What that robot's results have taken, with those that others of their attempt have pushed out: each was journaled.
  [[nodiscard]] std::size_t bytes_of(const std::string& robot) const;
  /// The same of all robots.
  [[nodiscard]] std::size_t bytes() const { return all_bytes_; }
  /// Robots with a result of it that says failed, retriable or interrupted, by id.
  [[nodiscard]] std::vector<std::string> failed_by(TaskIndex task) const;
  /// Two different FINISHED results of one task and iteration: it may have been done twice.
  [[nodiscard]] bool finished_twice(TaskIndex task) const;
  [[nodiscard]] std::vector<bool> final_tasks(std::size_t tasks) const;
  /// The tasks that have any result, ascending.
  [[nodiscard]] std::vector<TaskIndex> tasks() const;

  /// By what the results say: a robot can sign one thing in several ways.
  bool operator==(const ResultSet& other) const;

 private:
  std::map<std::string, std::size_t> bytes_;  ///< by robot
  std::size_t all_bytes_ = 0;
  std::map<TaskIndex, std::vector<HeldResult>> by_task_;  ///< each list by iteration, attempt, then as they are kept
};

}  // namespace trb::scheduler
