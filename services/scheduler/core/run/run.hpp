// One run as this node knows it: the facts that are journaled, what follows from them, and what is waited for. Each
// part keeps its own state; a Run sees that a fact reaches every part that it changes.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/scheduler/core/run/decision_checks.hpp"
#include "services/scheduler/core/run/deliveries.hpp"
#include "services/scheduler/core/run/epochs.hpp"
#include "services/scheduler/core/run/facts.hpp"
#include "services/scheduler/core/run/members.hpp"
#include "services/scheduler/core/run/next_visit.hpp"
#include "services/scheduler/core/run/open_tasks.hpp"
#include "services/scheduler/core/run/orders.hpp"
#include "services/scheduler/core/run/pending_work.hpp"
#include "services/scheduler/core/run/record_checks.hpp"
#include "services/scheduler/core/run/recovery.hpp"
#include "services/scheduler/core/run/reports.hpp"
#include "services/scheduler/core/run/run_definition.hpp"

namespace trb::scheduler {

class Run {
 public:
  /// Opens a signed start. `self` need not be a member: a decision may make it one. Errors: those of
  /// RunDefinition::open and Members::open.
  static Result<std::unique_ptr<Run>> open(const SignedRecord& record,
                                           const std::shared_ptr<Certificates>& certificates, const std::string& self);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  [[nodiscard]] const std::string& id() const { return definition_.id(); }
  [[nodiscard]] const std::vector<Task>& tasks() const { return definition_.tasks(); }
  [[nodiscard]] std::optional<TaskIndex> index_of(const std::string& task) const { return definition_.index_of(task); }
  [[nodiscard]] const RunDefinition& definition() const { return definition_; }
  [[nodiscard]] const Members& members() const { return members_; }
  [[nodiscard]] const Epochs& epochs() const { return epochs_; }
  [[nodiscard]] const Facts& facts() const { return facts_; }
  [[nodiscard]] const ResultSet& results() const { return facts_.results(); }
  [[nodiscard]] const Orders& orders() const { return orders_; }
  [[nodiscard]] const OpenTasks& open_tasks() const { return open_tasks_; }
  [[nodiscard]] const RecordChecks& checks() const { return checks_; }
  [[nodiscard]] const DecisionChecks& decision_checks() const { return decision_checks_; }
  [[nodiscard]] const Reports& reports() const { return reports_; }
  [[nodiscard]] Reports& reports() { return reports_; }
  [[nodiscard]] const Deliveries& deliveries() const { return deliveries_; }
  [[nodiscard]] Deliveries& deliveries() { return deliveries_; }
  [[nodiscard]] const PendingWork& work() const { return work_; }
  [[nodiscard]] PendingWork& work() { return work_; }
  [[nodiscard]] const Recovery& recovery() const { return recovery_; }
  [[nodiscard]] Recovery& recovery() { return recovery_; }
  [[nodiscard]] const NextVisit& next_visit() const { return next_visit_; }
  [[nodiscard]] NextVisit& next_visit() { return next_visit_; }

  // What is journaled: the same when it happens and when it is restored. Errors (of a journal that was not written by
  // this service): bad_value, conflict.
  Status apply(const JournalRun& fact);
  Status apply(const JournalStart& fact);
  Status apply(const JournalResult& fact);
  Status apply(const JournalChoice& fact);
  Status apply(const JournalDelivered& fact);
  Status apply(const JournalAbort& fact);
  Status apply(const JournalDecision& fact);
  Status apply(const JournalPause& fact);
  Status apply(const JournalEnd& fact);
  /// The same as apply(JournalResult) for a result that has been checked; true if it was new.
  bool add(HeldResult held);
  /// The same for a choice that has been checked. What is chosen stays chosen: false if every task of it is.
  bool add(HeldChoice held);
  /// An order to let the run go on that does not count, because it leaves out a task that was done twice.
  void outbid(const PauseOrder& order) { orders_.outbid(order); }
  /// This node's next order to hold the run, or to let it go on, has a number above this. A cloud node goes beyond all
  /// that robots can undo, if a robot's order lets the run go on.
  [[nodiscard]] std::uint32_t pause_number() const;

  /// A result that another node sends, checked. Errors: those of RecordChecks::received_result; too_large (its robot
  /// has no room left for results of this run).
  [[nodiscard]] Result<HeldResult> received_result(const SignedRecord& record) const;

  /// Takes the pause up before a task's robot tries it again, if it does: what is left of it by the steady time, or all
  /// of it if this node is its robot's. Another's clock makes it no longer.
  void await_retry(TaskIndex task, MonotonicTime now, UtcTime steady);

  /// What a baton of `giver` states of each task; the results that this node needs are requested from it.
  void receive(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks, const std::string& giver);
  /// Final by a held result; elsewhere than at the run's judge and decider also by what a baton states.
  [[nodiscard]] std::vector<bool> known_final() const;
  /// The part of known_final() that is known to be SKIPPED.
  [[nodiscard]] std::vector<bool> known_skipped() const;

  /// Neither aborted, nor FINISHED, nor, by the steady time, past its own.
  [[nodiscard]] bool is_open(UtcTime steady) const { return orders_.is_open() && !definition_.expired(steady); }
  /// This node, its judge, asks the members what they hold of it: it decides, passes and signs nothing yet.
  [[nodiscard]] bool is_recovering() const { return orders_.is_open() && recovery_.is_open(); }
  /// Something of it shows that this node has signed for it before: a decision, a choice, a result or an order.
  [[nodiscard]] bool has_signed() const;
  /// The members that have not told all yet.
  [[nodiscard]] std::vector<std::string> silent_members() const {
    return recovery_.silent(members_.ids(), epochs_.self());
  }
  /// Tasks may be begun: it is open, nothing holds it, and it is not being recovered.
  [[nodiscard]] bool may_start(UtcTime steady) const;
  /// This node has nothing left to do: its tasks are final, or one has failed and none could begin; and nothing is owed
  /// or waited for.
  [[nodiscard]] bool is_idle() const;
  /// Rises with every fact, and with what others report anew.
  [[nodiscard]] std::uint64_t version() const { return version_ + reports_.changes() + recovery_.changes(); }
  /// Rises also with what is owed: its tasks' timers follow from all that.
  [[nodiscard]] std::uint64_t timers_version() const { return version() + deliveries_.pending().changes(); }

 private:
  Run(RunDefinition definition, Members members, const std::shared_ptr<Certificates>& certificates,
      const std::string& self);
  [[nodiscard]] bool is_stuck() const;
  /// Final by a held result or by what a baton states.
  [[nodiscard]] std::vector<bool> reported_final() const;
  void note_told(const std::string& member);
  void adopt(const SignedRecord& record, const Decision& decision);

  NextVisit next_visit_;
  std::shared_ptr<Certificates> certificates_;
  RunDefinition definition_;
  Members members_;
  Epochs epochs_;
  Facts facts_;
  Orders orders_;
  Reports reports_;
  Deliveries deliveries_;
  PendingWork work_;
  Recovery recovery_;
  OpenTasks open_tasks_;
  RecordChecks checks_;
  DecisionChecks decision_checks_;
  std::uint64_t version_ = 0;
};

}  // namespace trb::scheduler
