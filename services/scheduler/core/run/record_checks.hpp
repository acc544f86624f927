// Whether a signed record of a run may be believed: its signer, its run, its epoch, and that it contradicts nothing.
#pragma once

#include <string>

#include "services/scheduler/core/run/epochs.hpp"
#include "services/scheduler/core/run/facts.hpp"
#include "services/scheduler/core/run/members.hpp"

namespace trb::scheduler {

class RecordChecks {
 public:
  /// All must outlive it.
  RecordChecks(const RunDefinition& definition, const Members& members, const Epochs& epochs)
      : definition_(definition), members_(members), epochs_(epochs) {}

  /// A result: signer, digest, epoch, task, assignee. Errors: not_permitted, conflict, bad_value and those of
  /// open_record.
  [[nodiscard]] Result<HeldResult> result(const SignedRecord& record) const;
  /// A result that another node sends: besides, its attempt is one that its robot had in that epoch, the first and the
  /// task's retries (one more for what was never begun). A journal may have others, of nodes that counted on.
  [[nodiscard]] Result<HeldResult> received_result(const SignedRecord& record) const;
  /// A choice on tasks: signer, digest, epoch, tasks, and that each verdict is that of its reading. Errors:
  /// not_permitted, conflict, source_mismatch, bad_value and those of open_record.
  [[nodiscard]] Result<HeldChoice> choice(const SignedRecord& record) const;
  /// An order to hold the run or to let it go on. Errors: not_permitted, conflict, source_mismatch, bad_value and those
  /// of open_record.
  [[nodiscard]] Result<PauseOrder> pause(const SignedRecord& record) const;
  /// An order that another node sends or a person gives: besides, only the judge holds the run for tasks that were done
  /// twice, only who outranks robots says that somebody has looked at them, and each is a task of the run, named once.
  /// A journal of an earlier version may have others. Errors: those of pause().
  [[nodiscard]] Result<PauseOrder> received_pause(const SignedRecord& record) const;
  /// What received_pause() checks beside pause(). Errors: not_permitted, bad_value.
  [[nodiscard]] Status check_doubles(const PauseOrder& order) const;
  /// Its orders to hold the run or to let it go on have numbers beyond those of robots: a cloud node, or the judge.
  [[nodiscard]] bool outranks_robots(const std::string& node) const;
  /// An order to abort the run. Errors: not_permitted, conflict, source_mismatch and those of open_record.
  [[nodiscard]] Result<AbortOrder> abort(const SignedRecord& record) const;
  /// An order to abort, or else one to hold.
  [[nodiscard]] Status order(const SignedRecord& record) const;
  /// The judge's record that the run has FINISHED. Errors: as of an order, and bad_value.
  [[nodiscard]] Result<RunEnd> end(const SignedRecord& record) const;

 private:
  [[nodiscard]] Result<const Certificate*> signer_of(const SignedRecord& record) const;
  template <class Order>
  [[nodiscard]] Result<Order> open_order(const SignedRecord& record, std::string_view purpose) const;
  [[nodiscard]] Status check_number(const PauseOrder& order) const;
  [[nodiscard]] Status check_attempt(TaskIndex task, const TaskResult& result) const;
  [[nodiscard]] Status check_author(TaskIndex task, const TaskResult& result, const Certificate& signer) const;
  [[nodiscard]] Status check_verdict(const Choice& choice, const ChosenTask& chosen) const;

  const RunDefinition& definition_;
  const Members& members_;
  const Epochs& epochs_;
};

}  // namespace trb::scheduler
