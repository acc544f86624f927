// Decisions, which start the next epoch, and tasks that are asked back before one.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class DecisionHandler {
 public:
  using Taken = Takes<RunDecision, DecisionJournaled, ReleaseTasks>;

  /// Both must outlive it.
  DecisionHandler(std::string node, RunLookup& lookup, RunJournal& journal)
      : node_(std::move(node)), lookup_(lookup), journal_(journal) {}

  void handle(const RunDecision& body, const Inbound& from, Step step);
  void handle(const DecisionJournaled& body, const Inbound& from, Step step);
  void handle(const ReleaseTasks& body, const Inbound& from, Step step);

 private:
  /// `here`: made by this node, which checks it against what it knows of the tasks.
  Status keep(Run& run, const SignedRecord& record, bool here, Step step);
  [[nodiscard]] Status check_release(const Run& run, const ReleaseTasks& body, const Inbound& from) const;

  std::string node_;
  RunLookup& lookup_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
