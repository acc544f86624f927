// Batons: those that other nodes pass to this one, and the answers to those that this one passed on.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class BatonHandler {
 public:
  using Taken = Takes<Baton, BatonJournaled>;

  /// All must outlive it.
  BatonHandler(std::string node, const RunStore& runs, const Executor& executor, RunLookup& lookup, RunJournal& journal)
      : node_(std::move(node)), runs_(runs), executor_(executor), lookup_(lookup), journal_(journal) {}

  void handle(const Baton& body, const Inbound& from, Step step);
  void handle(const BatonJournaled& body, const Inbound& from, Step step);
  /// A member refuses its baton.
  void on_refusal(const Nack& nack, const Inbound& from, Step step);

 private:
  struct Content;
  [[nodiscard]] Status check(const Run& run, const Baton& baton, Step step) const;
  [[nodiscard]] Result<Content> open(const Run& run, const Baton& baton) const;
  void request_decisions(Run& run, const Inbound& from, Step step);
  [[nodiscard]] bool began_long_ago(const Run& run, const std::vector<TaskIndex>& tasks, Now now) const;
  void repeat_progress(const Run& run, const Inbound& from, Step step) const;

  std::string node_;
  const RunStore& runs_;
  const Executor& executor_;
  RunLookup& lookup_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
