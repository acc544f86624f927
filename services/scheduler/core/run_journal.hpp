// Journals what a step learns of a run, and applies it: by the same code that restores it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

class RunJournal {
 public:
  /// `node`: the own one. Both must outlive it.
  RunJournal(std::string node, RunStore& runs, const LostJournal& lost)
      : node_(std::move(node)), runs_(runs), lost_(lost) {}
  RunJournal(const RunJournal&) = delete;
  RunJournal& operator=(const RunJournal&) = delete;

  /// A run becomes known.
  Run& add(std::unique_ptr<Run> run, bool submitted_here, Step step);
  /// A run becomes known by another node. `is_first`: its submitter passes it for the first time, and nothing is
  /// decided. Its judge, this node, may have had it in a journal that was lost, and asks all members; unless the run is
  /// young and no journal of then was lost.
  Run& learn(std::unique_ptr<Run> run, bool is_first, Step step);
  /// The submitter passes a known run for the first time.
  void note_first(Run& run, Step step);
  /// Of a run that its submitter says is new: nobody needs to be asked any more if it is young, or once all who are up
  /// have told what they hold, and none of it is this node's own.
  void look_again(Run& run, Step step);
  /// That member has told all that it holds of the run.
  void keep_told(Run& run, const std::string& member, Step step);
  /// A known run is submitted here. Error: conflict.
  Status note_submitted(Run& run, Step step);

  // What has been checked.
  void keep_result(Run& run, HeldResult held, Step step);
  void keep_choice(Run& run, HeldChoice held, Step step);
  void keep_decision(Run& run, const SignedRecord& record, bool here, Step step);
  void keep_end(Run& run, const SignedRecord& end, Step step);
  /// Another node has journaled what it was owed; counted only if nothing was owed.
  void keep_delivery(Run& run, DeliveryKind kind, const Inbound& from, std::vector<TaskIndex> tasks,
                     std::uint32_t epoch, Step step);
  /// That node is to get nothing more of it, though it has not journaled what it is owed.
  void give_up(Run& run, const std::string& to, Step step);

  // What is checked first. Errors: those of RecordChecks and DecisionChecks.
  Status keep_abort(Run& run, const SignedRecord& order, bool here, Step step);
  Status keep_pause(Run& run, const SignedRecord& order, bool here, Step step);
  /// Orders that came with a definition or a baton. Error: of the first bad one; none is kept then.
  Status keep_orders(Run& run, const std::vector<SignedRecord>& orders, Step step);
  /// Decisions that came with a definition, up to the first bad one.
  Status keep_decisions(Run& run, const std::vector<SignedRecord>& records, Step step);

 private:
  [[nodiscard]] bool may_be_lost(const Run& run, Step step) const;
  [[nodiscard]] static bool is_young(const Run& run, Step step);
  static void keep_recovery(Run& run, const std::string& node, std::string_view what, Step step);

  std::string node_;
  RunStore& runs_;
  const LostJournal& lost_;
};

}  // namespace trb::scheduler
