// Signed results and choices of other nodes, and their reports on tasks that are under way.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class ResultHandler {
 public:
  using Taken = Takes<NeedResults, Results, ResultsJournaled, TaskProgress>;

  /// All must outlive it.
  ResultHandler(const RunStore& runs, RunLookup& lookup, RunJournal& journal)
      : runs_(runs), lookup_(lookup), journal_(journal) {}

  void handle(const NeedResults& body, const Inbound& from, Step step);
  void handle(const Results& body, const Inbound& from, Step step);
  void handle(const ResultsJournaled& body, const Inbound& from, Step step);
  void handle(const TaskProgress& body, const Inbound& from, Step step);

 private:
  /// Each one adds what it keeps; returns the last error.
  Status keep_choices(Run& run, const Results& body, Step step);
  Status keep_results(Run& run, const Results& body, std::vector<AttemptKey>& kept, Step step);

  /// Of a run that is being recovered: a member's answer.
  void note_told(Run& run, const Results& body, const Inbound& from, Step step);

  const RunStore& runs_;
  RunLookup& lookup_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
