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
#include "services/scheduler/core/certificates.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/inquiry.hpp"
#include "services/scheduler/core/pending_deliveries.hpp"
#include "services/scheduler/core/results.hpp"

namespace trb::scheduler {

/// A choice whose signature has been checked, with the record that proves it to others.
struct HeldChoice {
  SignedRecord record;
  Choice choice;
};

/// What is to become of a task whose predecessors are all final. `binds`: it goes once it has a robot.
enum class Fate : std::uint8_t { undecided = 0, goes, binds, skipped };

/// A bound on what a task may be tried again, by retries and decisions together.
constexpr std::uint32_t kMaxAttempts = 64;
/// As many as a Definition carries.
constexpr std::size_t kMaxDecisions = 64;
/// Orders that hold a run are numbered up to this; one more lets it go on, whatever was said before.
constexpr std::uint32_t kMaxPauses = 1000;

class Run {
 public:
  /// Opens a signed start: the submitter's signature, every member's certificate, the digest, the graph. `self` need
  /// not be a member: a decision may make it one. Errors: those of open_record, open_certificate_any_time and
  /// check_run_start.
  static Result<Run> open(const SignedRecord& record, const std::shared_ptr<Certificates>& certificates,
                          const std::string& self);

  [[nodiscard]] const std::string& id() const { return start_.run; }
  [[nodiscard]] const RunStart& start() const { return start_; }
  [[nodiscard]] const SignedRecord& record() const { return record_; }
  [[nodiscard]] const std::vector<Task>& tasks() const { return start_.scenario.tasks; }
  /// Whose the task is in this epoch.
  [[nodiscard]] const std::string& robot_of(TaskIndex task) const { return robots_[task]; }
  /// Whose it was in that epoch, 1 to epoch().
  [[nodiscard]] const std::string& robot_in(TaskIndex task, std::uint32_t epoch) const;
  /// Whose a ruled task was before the last ruling.
  [[nodiscard]] const std::string& robot_before(TaskIndex task) const { return robot_in(task, since_[task] - 1); }
  [[nodiscard]] std::uint32_t epoch() const { return static_cast<std::uint32_t>(decisions_.size()) + 1; }
  [[nodiscard]] const std::vector<Decision>& decisions() const { return decisions_; }
  [[nodiscard]] const std::vector<SignedRecord>& decision_records() const { return decision_records_; }
  /// The only node that may decide on this run: the first cloud node among the start's members; empty: none.
  [[nodiscard]] const std::string& decider() const { return decider_; }
  /// Who holds every result in the end, and says that the run has FINISHED: the decider, or without one the submitter.
  [[nodiscard]] const std::string& judge() const { return decider_.empty() ? start_.submitter : decider_; }
  /// The start has left it to the decider to choose its robot, and that has not happened: the decider's node holds it.
  [[nodiscard]] bool is_unbound(TaskIndex task) const { return !is_ruled(task) && robot_of(task) == decider_; }
  /// It is due, and the decider's node has said that it has no robot.
  [[nodiscard]] bool wants_robot(TaskIndex task) const;
  [[nodiscard]] bool is_conditional(TaskIndex task) const { return !tasks()[task].when.empty(); }
  [[nodiscard]] bool has_conditions() const { return has_conditions_; }
  /// True if this node may have to say of a task that it is SKIPPED.
  [[nodiscard]] bool may_skip() const { return has_conditions_ || skips_on_failure_ || !decisions_.empty(); }
  /// Who evaluates a task's condition.
  [[nodiscard]] const std::string& chooser_of(TaskIndex task) const {
    return robot_of(trb::chooser_of(start_.scenario, task));
  }
  [[nodiscard]] bool chooses_here(TaskIndex task) const { return is_conditional(task) && chooser_of(task) == self_; }
  /// True if this node executes the task.
  [[nodiscard]] bool is_own(TaskIndex task) const { return robot_of(task) == self_; }
  /// True if this node executes the task or evaluates its condition.
  [[nodiscard]] bool concerns(TaskIndex task) const { return robot_of(task) == self_ || chooses_here(task); }
  [[nodiscard]] std::optional<TaskIndex> index_of(const std::string& task) const;
  [[nodiscard]] bool is_member(const std::string& node) const { return members_.contains(node); }
  /// In the order of the start, then of the decisions.
  [[nodiscard]] const std::vector<std::string>& members() const { return member_ids_; }
  /// The cloud nodes among the members, without this one, in the order of the start.
  [[nodiscard]] std::vector<std::string> clouds() const;
  /// By the steady time, here and below.
  [[nodiscard]] bool expired(UtcTime steady) const { return steady.ns >= start_.expires; }
  /// Until when messages about it are refused once it is over.
  [[nodiscard]] UtcTime buried_until() const { return UtcTime{start_.expires} + std::chrono::hours(24); }
  /// The next moment at which its time to live changes something.
  [[nodiscard]] std::optional<UtcTime> next_end(UtcTime steady) const;

  /// Checks a result of this run: signer, digest, epoch, task, assignee. Errors: not_permitted, conflict, bad_value and
  /// those of open_record.
  [[nodiscard]] Result<HeldResult> check_result(const SignedRecord& record) const;
  /// Checks a choice on tasks of this run: signer, digest, epoch, tasks, and that each verdict is that of its reading.
  /// Errors: not_permitted, conflict, bad_value and those of open_record.
  [[nodiscard]] Result<HeldChoice> check_choice(const SignedRecord& record) const;
  /// Checks the decision that makes the next epoch. Errors: not_permitted, conflict (of another epoch, or not built on
  /// the decision before), bad_value, too_large and those of open_record and open_certificate_any_time.
  [[nodiscard]] Result<Decision> check_decision(const SignedRecord& record) const;
  /// Of a decision that check_decision has passed, by what this node holds: that nothing it rules on is final by now,
  /// and that what is said to have been given up has been. Only its decider can tell. Error: conflict.
  [[nodiscard]] Status check_grounds(const Decision& decision) const;
  /// Checks an order to hold this run or to let it go on. Errors: not_permitted, conflict and those of open_record.
  [[nodiscard]] Result<PauseOrder> check_pause(const SignedRecord& record) const;
  /// Checks an order to abort this run. Errors: not_permitted, conflict and those of open_record.
  [[nodiscard]] Result<AbortOrder> check_abort(const SignedRecord& record) const;
  /// Checks the judge's word that this run has FINISHED. Errors: not_permitted, conflict and those of open_record.
  [[nodiscard]] Result<RunEnd> check_end(const SignedRecord& record) const;

  // What is journaled. Errors (of a journal that was not written by this service): bad_value, conflict.
  Status apply(const JournalRun& fact);
  Status apply(const JournalStart& fact);
  Status apply(const JournalResult& fact);
  Status apply(const JournalChoice& fact);
  Status apply(const JournalDelivered& fact);
  Status apply(const JournalAbort& fact);
  Status apply(const JournalDecision& fact);
  Status apply(const JournalPause& fact);
  Status apply(const JournalEnd& fact);
  /// The same as apply(JournalResult) for a result that check_result has passed; true if it was new.
  bool add(HeldResult held);
  /// The same for a choice that check_choice has passed. What is chosen stays chosen: false if every task of it is.
  bool add(HeldChoice held);

  [[nodiscard]] bool submitted_here() const { return submitted_here_; }
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
  /// True if a decision has taken that attempt's task from its robot, or has it done again.
  [[nodiscard]] bool is_void(TaskIndex task, std::uint32_t attempt) const { return attempt < first_attempt_[task]; }
  /// True if the task was moved, repeated or skipped by a decision.
  [[nodiscard]] bool is_ruled(TaskIndex task) const { return since_[task] > 1; }
  /// True if none of these tasks was ruled on in a later epoch than that.
  [[nodiscard]] bool is_of_epoch(const std::vector<TaskIndex>& tasks, std::uint32_t epoch) const;
  /// The order that counts; nullptr if there was none.
  [[nodiscard]] const PauseOrder* pause() const { return pause_ ? &*pause_ : nullptr; }
  [[nodiscard]] const SignedRecord& pause_record() const { return pause_record_; }
  [[nodiscard]] bool held() const { return pause_ && pause_->paused; }
  /// It names every task for which the run is held as done twice: a person has looked at them.
  [[nodiscard]] bool names_doubles(const PauseOrder& order) const;
  /// An order to let it go on that names not all of them: it does not count, and is outbid.
  void outbid(const PauseOrder& order);
  /// The number of the judge's next order to hold it.
  [[nodiscard]] std::uint32_t next_hold() const;
  /// The judge's hold has to be said anew.
  [[nodiscard]] bool is_outbid() const { return held_for_doubles() && outbid_ > pause_->number; }
  /// True if that order counts more than the one that is known. One that lets the run go on must name its doubles.
  [[nodiscard]] bool is_newer(const PauseOrder& order) const;
  [[nodiscard]] bool aborted() const { return abort_.has_value(); }
  [[nodiscard]] const SignedRecord& abort_order() const { return *abort_; }
  /// The orders that count, as they travel with definition and baton.
  [[nodiscard]] std::vector<SignedRecord> orders() const;
  /// Tasks that were done twice, and of which no order to let the run go on says that a person has looked.
  [[nodiscard]] const std::vector<std::string>& doubles() const { return doubles_; }
  /// There is one that the order which counts does not name.
  [[nodiscard]] bool has_new_double() const;
  /// It is held because of tasks that were done twice.
  [[nodiscard]] bool held_for_doubles() const { return held() && !pause_->doubles.empty(); }
  /// The judge's word that it has FINISHED is held.
  [[nodiscard]] bool ended() const { return end_.has_value(); }
  [[nodiscard]] const std::optional<SignedRecord>& end() const { return end_; }
  /// A start record without a result: nobody has said yet how it ended.
  [[nodiscard]] const JournalStart* open_start() const;
  /// The attempt that a start record is for.
  [[nodiscard]] Attempt attempt_for(const JournalStart& fact) const;
  [[nodiscard]] bool all_final() const;
  /// The tasks that wait for a word: failed, retriable, interrupted. What follows them waits, other branches go on.
  [[nodiscard]] std::vector<TaskIndex> problems() const;
  /// The task whose failure ends the run: its robot orders the abort, and the judge, if the robot is gone by then.
  [[nodiscard]] std::optional<TaskIndex> ending_task() const;
  /// Nothing stands before them on this node, and they are not known to have begun; ascending. Of tasks of other nodes
  /// only the judge knows, and who owes their batons.
  [[nodiscard]] std::vector<TaskIndex> due() const;
  /// Tasks of the judge's view that are behind nothing but their condition, which another node evaluates; ascending.
  [[nodiscard]] std::vector<TaskIndex> choosing_elsewhere() const;
  /// This node has nothing left to do: its tasks are final, and nothing is owed.
  [[nodiscard]] bool is_idle() const;
  /// Robots whose attempts at the task have not done it.
  [[nodiscard]] std::vector<std::string> failed_by(TaskIndex task) const { return results_.failed_by(task); }
  /// This node's tasks that could begin: not begun yet, all predecessors' final results held; ascending.
  [[nodiscard]] std::vector<TaskIndex> startable() const { return own_tasks_that(Fate::goes); }
  [[nodiscard]] std::vector<TaskIndex> unpassed() const;
  /// Owes the task's baton in the place of whoever has not passed it, unless it is known to have begun.
  void pass_instead(TaskIndex task);
  /// Tasks that the decider's node, this one, has to say of that a robot is wanted; ascending.
  [[nodiscard]] std::vector<TaskIndex> to_bind() const { return own_tasks_that(Fate::binds); }
  /// This node's tasks that are to be SKIPPED, and are not yet; ascending.
  [[nodiscard]] std::vector<TaskIndex> skippable() const { return own_tasks_that(Fate::skipped); }
  /// The tasks whose conditions this node has to evaluate now; ascending.
  [[nodiscard]] std::vector<TaskIndex> to_choose() const;
  /// SKIPPED, with the reason; to be signed.
  [[nodiscard]] TaskResult skipped_result(TaskIndex task, UtcTime now) const;
  /// This node's tasks that it was asked to give back and has not begun; ascending.
  [[nodiscard]] std::vector<TaskIndex> releasable() const;
  /// `released`, by a robot or for want of one; to be signed.
  [[nodiscard]] TaskResult released_result(TaskIndex task, UtcTime now) const;
  /// `failed` without having been begun; to be signed.
  [[nodiscard]] TaskResult unbegun_result(TaskIndex task, const std::string& why, UtcTime now) const;
  /// The task's data, with the values that earlier results give. Errors: those of fill_values.
  [[nodiscard]] Result<std::string> data_for(TaskIndex task) const;
  /// Rises with every fact.
  [[nodiscard]] std::uint64_t version() const { return version_; }

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

  PendingDeliveries deliveries;
  std::map<TaskIndex, Need> needs;
  std::map<TaskIndex, TaskState> progress;      ///< what TaskProgress told
  std::map<TaskIndex, std::string> waits;       ///< what TaskProgress told of a condition
  std::vector<Inquiry> inquiries;               ///< for the conditions that this node has to evaluate
  std::map<TaskIndex, Signature> skips;         ///< results that are being signed without an attempt
  std::map<TaskIndex, std::string> unbegun;     ///< why the task cannot be begun, and fails
  std::map<TaskIndex, MonotonicTime> retry_at;  ///< when a task may be tried again
  std::map<TaskIndex, MonotonicTime> pass_at;   ///< when the decider passes it on itself
  std::map<TaskIndex, MonotonicTime> due_at;    ///< since when a task is due, as far as this node has seen
  std::uint64_t looked_version = 0;             ///< of the facts behind pass_at and due_at
  std::set<TaskIndex> asked_back;               ///< by the decider
  std::optional<MonotonicTime> served;          ///< when this node's robot last began a task of it
  std::optional<Signature> abort_signature;     ///< of the order that a failed task makes this node give
  std::optional<Signature> hold_signature;      ///< of the order that a task done twice makes the judge give
  std::optional<Signature> end_signature;       ///< of the judge's word that it has FINISHED
  std::optional<MonotonicTime> over_at;         ///< when it goes to the archive
  std::map<std::string, std::string> refusals;  ///< who does not take its baton, and why
  Pace need_end;                                ///< when the judge is asked whether it is over
  std::set<std::string> asked_decisions;        ///< whom the decisions were asked of
  std::set<std::string> confirm_to;             ///< members that wait for AbortConfirmed

 private:
  Run() = default;
  Status open_members();
  Status check_ruling(const Decision& decision, const TaskRuling& ruling) const;
  [[nodiscard]] Result<std::map<std::string, Certificate>> open_new_members(const Decision& decision) const;
  void adopt(const Decision& decision);
  void owe_batons_anew();
  void index_own_tasks();
  [[nodiscard]] bool gives(TaskIndex task) const;
  [[nodiscard]] bool decider_gives(TaskIndex task) const;
  [[nodiscard]] bool has_passed(TaskIndex task) const;
  /// Its robot will try it again by itself.
  [[nodiscard]] bool tries_again(TaskIndex task, const TaskResult& result) const;
  /// There is a start record of the next attempt.
  [[nodiscard]] bool begun(TaskIndex task) const;
  [[nodiscard]] TaskResult own_result(TaskIndex task, TaskOutcome outcome, UtcTime now) const;
  void index_tasks();
  void owe_first_batons();
  void owe_results(TaskIndex task);
  void owe_to_successor(TaskIndex task);
  void owe_batons_after(TaskIndex task);
  [[nodiscard]] bool own_predecessors_final(TaskIndex task) const;
  [[nodiscard]] bool all_before_final(TaskIndex task) const;
  [[nodiscard]] bool all_before_skipped(TaskIndex task) const;
  [[nodiscard]] Fate fate_of(TaskIndex task) const;
  [[nodiscard]] std::vector<TaskIndex> own_tasks_that(Fate fate) const;
  /// To whom a task goes from here: who evaluates its condition, if that is not known to have happened, then its robot.
  [[nodiscard]] const std::string& next_hand(TaskIndex task) const;
  void owe_batons(const std::vector<TaskIndex>& tasks);
  void owe_to_members(DeliveryKind kind);
  [[nodiscard]] bool ends_run(TaskIndex task, const TaskResult& result) const;
  /// It is SKIPPED, and so is what follows nothing else.
  [[nodiscard]] bool takes_along(TaskIndex task) const;

  std::string self_;
  std::shared_ptr<Certificates> certificates_;
  std::string decider_;
  std::vector<std::string> robots_;           ///< of this epoch
  std::vector<std::uint32_t> since_;          ///< the epoch of the last ruling on a task; 1: none
  std::set<std::string> standing_;            ///< robots that lost a task by a person's word that they stand
  std::vector<std::uint32_t> first_attempt_;  ///< earlier ones are void, unless they are final
  std::vector<Decision> decisions_;
  std::vector<SignedRecord> decision_records_;
  std::vector<std::string> member_ids_;
  std::map<std::pair<TaskIndex, std::string>, std::uint32_t>
      passed_;  ///< in which epoch a task's baton was journaled there
  std::optional<PauseOrder> pause_;
  SignedRecord pause_record_;
  std::uint64_t version_ = 0;
  SignedRecord record_;
  RunStart start_;
  std::map<std::string, Certificate> members_;
  std::map<std::string, TaskIndex> index_;
  std::vector<std::vector<TaskIndex>> successors_;
  std::vector<TaskIndex> own_tasks_;
  std::vector<TaskIndex> concern_;  ///< tasks that this node executes or chooses on
  bool has_conditions_ = false;
  bool aborts_on_failure_ = false;
  bool skips_on_failure_ = false;
  bool submitted_here_ = false;
  ResultSet results_;
  std::vector<std::string> doubles_;
  std::uint32_t outbid_ = 0;            ///< number of an order that does not count
  std::set<std::string> seen_doubles_;  ///< that a person has looked at
  std::map<TaskIndex, std::shared_ptr<const HeldChoice>> choices_;
  std::map<TaskIndex, JournalStart> starts_;
  std::optional<SignedRecord> abort_;
  std::optional<SignedRecord> end_;
  std::vector<bool> heard_;
  std::vector<bool> heard_skipped_;
};

}  // namespace trb::scheduler
