// The facts of one run as this node knows them, and what follows from them. Facts are only added: journaled ones by
// apply(), the same when they happen and when they are restored; the rest is hearsay that a restart forgets.
#pragma once

#include <map>
#include <memory>
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
#include "services/scheduler/core/inquiry.hpp"
#include "services/scheduler/core/results.hpp"

namespace trb::scheduler {

/// A choice whose signature has been checked, with the record that proves it to others.
struct HeldChoice {
  SignedRecord record;
  Choice choice;
};

/// What is to become of a task whose predecessors are all final.
enum class Fate : std::uint8_t { undecided = 0, goes, skipped };

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
  [[nodiscard]] bool is_conditional(TaskIndex task) const { return !tasks()[task].when.empty(); }
  /// True if any task may be SKIPPED.
  [[nodiscard]] bool has_conditions() const { return has_conditions_; }
  /// Who evaluates a task's condition.
  [[nodiscard]] const std::string& chooser_of(TaskIndex task) const {
    return robot_of(trb::chooser_of(start_.scenario, task));
  }
  [[nodiscard]] bool chooses_here(TaskIndex task) const { return is_conditional(task) && chooser_of(task) == self_; }
  /// True if this node executes the task or evaluates its condition.
  [[nodiscard]] bool concerns(TaskIndex task) const { return robot_of(task) == self_ || chooses_here(task); }
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
  /// Checks a choice on tasks of this run: signer, digest, epoch, tasks, and that each verdict is that of its reading.
  /// Errors: not_permitted, conflict, bad_value and those of open_record.
  [[nodiscard]] Result<HeldChoice> check_choice(const SignedRecord& record) const;
  /// Checks an order to abort this run. Errors: not_permitted, conflict and those of open_record.
  [[nodiscard]] Result<AbortOrder> check_abort(const SignedRecord& record) const;

  // What is journaled. Errors (of a journal that was not written by this service): bad_value, conflict.
  Status apply(const JournalRun& fact);
  Status apply(const JournalStart& fact);
  Status apply(const JournalResult& fact);
  Status apply(const JournalChoice& fact);
  Status apply(const JournalDelivered& fact);
  Status apply(const JournalAbort& fact);
  /// The same as apply(JournalResult) for a result that check_result has passed; true if it was new.
  bool add(HeldResult held);
  /// The same for a choice that check_choice has passed. What is chosen stays chosen: false if every task of it is.
  bool add(HeldChoice held);

  [[nodiscard]] bool submitted_here() const { return submitted_here_; }
  [[nodiscard]] const ResultSet& results() const { return results_; }
  /// The choice on a task's condition, or nullptr.
  [[nodiscard]] const HeldChoice* choice_on(TaskIndex task) const;
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
  [[nodiscard]] std::vector<TaskIndex> startable() const { return own_tasks_that(Fate::goes); }
  /// This node's tasks that are to be SKIPPED, and are not yet; ascending.
  [[nodiscard]] std::vector<TaskIndex> skippable() const { return own_tasks_that(Fate::skipped); }
  /// The tasks whose conditions this node has to evaluate now; ascending.
  [[nodiscard]] std::vector<TaskIndex> to_choose() const;
  /// SKIPPED, with the reason; to be signed.
  [[nodiscard]] TaskResult skipped_result(TaskIndex task, UtcTime now) const;

  /// Final by a held result or by hearsay of a baton.
  [[nodiscard]] std::vector<bool> known_final() const;
  /// The part of known_final() that is known to be SKIPPED.
  [[nodiscard]] std::vector<bool> known_skipped() const;
  void hear(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks);
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
  std::map<TaskIndex, std::string> waits;   ///< what TaskProgress told of a condition
  std::vector<Inquiry> inquiries;           ///< for the conditions that this node has to evaluate
  std::map<TaskIndex, Signature> skips;     ///< results that are being signed
  std::set<std::string> confirm_to;         ///< members that wait for AbortConfirmed

 private:
  Run() = default;
  Status open_members(const FleetAuthority& authority);
  void index_tasks();
  void owe_first_batons();
  void owe_results(TaskIndex task);
  void owe_batons_after(TaskIndex task);
  [[nodiscard]] bool own_predecessors_final(TaskIndex task) const;
  [[nodiscard]] bool all_before_final(TaskIndex task) const;
  [[nodiscard]] bool all_before_skipped(TaskIndex task) const;
  [[nodiscard]] Fate fate_of(TaskIndex task) const;
  [[nodiscard]] std::vector<TaskIndex> own_tasks_that(Fate fate) const;
  /// To whom a task goes from here: who evaluates its condition, then its robot.
  [[nodiscard]] const std::string& next_hand(TaskIndex task) const;
  void owe_batons(const std::vector<TaskIndex>& tasks);

  std::string self_;
  SignedRecord record_;
  RunStart start_;
  std::map<std::string, Certificate> members_;
  std::map<std::string, TaskIndex> index_;
  std::vector<std::vector<TaskIndex>> successors_;
  std::vector<TaskIndex> own_tasks_;
  std::vector<TaskIndex> concern_;  ///< tasks that this node executes or chooses on
  bool has_conditions_ = false;
  bool submitted_here_ = false;
  ResultSet results_;
  std::map<TaskIndex, std::shared_ptr<const HeldChoice>> choices_;
  std::map<TaskIndex, JournalStart> starts_;
  std::optional<SignedRecord> abort_;
  bool abort_ordered_here_ = false;
  std::vector<bool> heard_;
  std::vector<bool> heard_skipped_;
};

}  // namespace trb::scheduler
