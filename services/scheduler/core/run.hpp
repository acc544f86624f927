// The facts of one run as this node knows them, and what follows from them. Facts are only added: journaled ones by
// apply(), the same when they happen and when they are restored; the rest is hearsay that a restart forgets.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/scenario/graph.hpp"
#include "common/security/keys.hpp"
#include "proto/bodies/journal.hpp"
#include "services/scheduler/core/duties.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/results.hpp"

namespace trb::scheduler {

class Run {
 public:
  /// Opens a signed start: the submitter's signature, every member's certificate, the digest, the graph; `self` must be
  /// a member. Errors: those of open_record, open_certificate_any_time and check_run_start.
  static Result<Run> open(const SignedRecord& record, const FleetAuthority& authority, const std::string& self);

  [[nodiscard]] const std::string& id() const { return start_.run; }
  [[nodiscard]] const RunStart& start() const { return start_; }
  [[nodiscard]] const SignedRecord& record() const { return record_; }
  [[nodiscard]] const std::vector<Task>& tasks() const { return start_.scenario.tasks; }
  [[nodiscard]] const std::string& robot_of(TaskIndex task) const { return start_.first.robots[task]; }
  [[nodiscard]] std::optional<TaskIndex> index_of(const std::string& task) const;
  [[nodiscard]] bool is_member(const std::string& node) const { return members_.contains(node); }
  /// The cloud nodes among the members, without this one, in the order of the start.
  [[nodiscard]] std::vector<std::string> clouds() const;
  [[nodiscard]] bool expired(UtcTime now) const { return now.ns >= start_.expires; }
  /// Until when messages about it are refused once it is over.
  [[nodiscard]] UtcTime buried_until() const { return UtcTime{start_.expires} + std::chrono::hours(24); }
  /// The next moment at which time alone changes something.
  [[nodiscard]] std::optional<UtcTime> next_end(UtcTime now) const;

  /// Checks a result of this run: signer, digest, epoch, task, assignee. Errors: not_permitted, conflict, bad_value and
  /// those of open_record.
  [[nodiscard]] Result<HeldResult> check_result(const SignedRecord& record) const;
  /// Checks an order to abort this run. Errors: not_permitted, conflict and those of open_record.
  [[nodiscard]] Result<AbortOrder> check_abort(const SignedRecord& record) const;

  // What is journaled. Errors (of a journal that was not written by this service): bad_value, conflict.
  Status apply(const JournalRun& fact);
  Status apply(const JournalStart& fact);
  Status apply(const JournalResult& fact);
  Status apply(const JournalDelivered& fact);
  Status apply(const JournalAbort& fact);
  /// The same as apply(JournalResult) for a result that check_result has passed; true if it was new.
  bool add(HeldResult held);

  [[nodiscard]] bool submitted_here() const { return submitted_here_; }
  [[nodiscard]] const ResultSet& results() const { return results_; }
  [[nodiscard]] bool aborted() const { return abort_.has_value(); }
  [[nodiscard]] const SignedRecord& abort_order() const { return *abort_; }
  [[nodiscard]] bool abort_ordered_here() const { return abort_ordered_here_; }
  /// A start record without a result: nobody has said yet how it ended.
  [[nodiscard]] const JournalStart* open_start() const;
  /// The attempt that a start record is for.
  [[nodiscard]] Attempt attempt_for(const JournalStart& fact) const;
  [[nodiscard]] bool all_final() const;
  /// The tasks that stand in the way of the run: failed, retriable, interrupted, or finished twice.
  [[nodiscard]] std::vector<TaskIndex> troubles() const;
  /// This node's tasks that could begin: not begun yet, all predecessors' final results held; ascending.
  [[nodiscard]] std::vector<TaskIndex> startable() const;

  /// Final by a held result or by hearsay of a baton.
  [[nodiscard]] std::vector<bool> known_final() const;
  void hear(const std::vector<bool>& final_tasks);
  /// Results that this node's next tasks need, that are said to be final and are not held: ask `giver`.
  void note_needs(const std::string& giver);
  void forget_needs(const std::string& giver);

  struct Need {
    std::string giver;
    BackOff timer;
  };

  Duties duties;
  std::map<TaskIndex, Need> needs;
  std::map<TaskIndex, TaskState> progress;  ///< what TaskProgress told
  std::set<std::string> confirm_to;         ///< members that wait for AbortConfirmed

 private:
  Run() = default;
  Status open_members(const FleetAuthority& authority);
  void index_tasks();
  void owe_first_batons();
  void owe_results(TaskIndex task);
  void owe_batons_after(TaskIndex task);
  [[nodiscard]] bool own_predecessors_final(TaskIndex task) const;

  std::string self_;
  SignedRecord record_;
  RunStart start_;
  std::map<std::string, Certificate> members_;
  std::map<std::string, TaskIndex> index_;
  std::vector<std::vector<TaskIndex>> successors_;
  std::vector<TaskIndex> own_tasks_;
  bool submitted_here_ = false;
  ResultSet results_;
  std::map<TaskIndex, JournalStart> starts_;
  std::optional<SignedRecord> abort_;
  bool abort_ordered_here_ = false;
  std::vector<bool> heard_;
};

}  // namespace trb::scheduler
