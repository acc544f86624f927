// Orders that hold a run and let it go on: a person's, and the judge's own when a task was done twice. Running tasks
// are finished; none is begun.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class PauseHandler {
 public:
  using Taken = Takes<RunPause, PauseJournaled>;

  /// All must outlive it.
  PauseHandler(std::string node, const Executor& executor, RunLookup& lookup, RunJournal& journal)
      : node_(std::move(node)), executor_(executor), lookup_(lookup), journal_(journal) {}

  void handle(const RunPause& body, const Inbound& from, Step step);
  void handle(const PauseJournaled& body, const Inbound& from, Step step);

  /// At a step's end: the judge has its order signed if a task was done twice. It holds the run everywhere until a
  /// person has looked.
  void hold_for_doubles(Run& run, Step step) const;
  /// Keeps that order once it is signed; false if the record is no such order.
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

 private:
  /// For a person's order on this node.
  [[nodiscard]] Status check_state(const Run& run, Step step) const;
  [[nodiscard]] static Status check_doubles(const Run& run, const PauseOrder& order);
  void confirm(Run& run, const PauseOrder& order, const Inbound& from, Step step);

  std::string node_;
  const Executor& executor_;
  RunLookup& lookup_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
