// What the submitter has signed of a run: its tasks, members and times. It never changes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/scenario/decision_rule.hpp"
#include "common/scenario/graph.hpp"
#include "services/scheduler/core/run/certificates.hpp"

namespace trb::scheduler {

/// A bound on what a task may be tried again, by retries and decisions together.
constexpr std::uint32_t kMaxAttempts = 64;

class RunDefinition {
 public:
  /// Opens a signed start: the submitter's signature, the digest, the graph. Errors: those of open_record,
  /// open_certificate_any_time and check_run_start.
  static Result<RunDefinition> open(const SignedRecord& record, Certificates& certificates);

  [[nodiscard]] const std::string& id() const { return start_.run; }
  [[nodiscard]] const RunStart& start() const { return start_; }
  [[nodiscard]] const SignedRecord& record() const { return record_; }
  /// As compact_start() makes it, once: each member may ask, any number of times. nullptr: it travels whole.
  [[nodiscard]] const Blob* compact(bool counts_on) const;
  static constexpr std::size_t kTagSize = 8;
  /// Names run and digest in a short form.
  [[nodiscard]] const Bytes& tag() const { return tag_; }
  [[nodiscard]] const std::vector<Task>& tasks() const { return start_.scenario.tasks; }
  [[nodiscard]] const DecisionRule& rule() const { return rule_; }
  [[nodiscard]] std::optional<TaskIndex> index_of(const std::string& task) const;
  [[nodiscard]] const std::vector<TaskIndex>& successors(TaskIndex task) const { return successors_[task]; }

  [[nodiscard]] bool is_conditional(TaskIndex task) const { return !tasks()[task].when.empty(); }
  [[nodiscard]] bool has_conditions() const { return has_conditions_; }
  /// Some task's failure skips it.
  [[nodiscard]] bool skips_on_failure() const { return skips_on_failure_; }
  /// Some task's failure ends the run.
  [[nodiscard]] bool aborts_on_failure() const { return aborts_on_failure_; }
  /// A result with which the task ends the run.
  [[nodiscard]] bool ends_run(TaskIndex task, const TaskResult& result) const;

  /// By the steady time, here and below.
  [[nodiscard]] bool expired(UtcTime steady) const { return steady.ns >= start_.expires; }
  /// Until when messages about it are refused once it is over.
  [[nodiscard]] UtcTime buried_until() const { return UtcTime{start_.expires} + std::chrono::hours(24); }
  /// The next moment at which its time to live changes something.
  [[nodiscard]] std::optional<UtcTime> next_end(UtcTime steady) const;

 private:
  RunDefinition(const SignedRecord& record, RunStart start);

  SignedRecord record_;
  mutable std::array<std::optional<std::optional<Blob>>, 2> compact_;  ///< by counts_on
  RunStart start_;
  Bytes tag_;
  DecisionRule rule_;
  std::map<std::string, TaskIndex> index_;
  std::vector<std::vector<TaskIndex>> successors_;
  bool has_conditions_ = false;
  bool skips_on_failure_ = false;
  bool aborts_on_failure_ = false;
};

}  // namespace trb::scheduler
