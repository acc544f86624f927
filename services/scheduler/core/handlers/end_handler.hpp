// The record that a run has FINISHED: its judge signs it, and the others request it.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class EndHandler {
 public:
  using Taken = Takes<RunOver, NeedEnd>;

  /// All must outlive it.
  EndHandler(std::string node, const RunStore& runs, const Executor& executor, RunLookup& lookup, RunJournal& journal)
      : node_(std::move(node)), runs_(runs), executor_(executor), lookup_(lookup), journal_(journal) {}

  void handle(const RunOver& body, const Inbound& from, Step step);
  void handle(const NeedEnd& body, const Inbound& from, Step step);

  /// At a step's end, at the judge: has its record signed once everything is done.
  void sign_end(Run& run, Step step) const;
  /// At a step's end, elsewhere: a node with nothing left to do requests it now and then.
  void request_end(Run& run, Step step) const;
  /// Keeps the judge's own record once it is signed, and sends it to every member; false if it is another one.
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

 private:
  void request_missing(Run& run, const std::string& member) const;

  std::string node_;
  const RunStore& runs_;
  const Executor& executor_;
  RunLookup& lookup_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
