// Orders that end a run: a person's, and this node's own when a task fails that ends it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class AbortHandler {
 public:
  using Taken = Takes<RunAbort, AbortConfirmed>;
  /// What the own router tells all its services.
  using Answers = Takes<PeerExpired, PeerJoined, RevokedNodes>;

  /// All must outlive it.
  AbortHandler(std::string node, const RunStore& runs, const Executor& executor, RunLookup& lookup, RunJournal& journal)
      : node_(std::move(node)), runs_(runs), executor_(executor), lookup_(lookup), journal_(journal) {}

  void handle(const RunAbort& body, const Inbound& from, Step step);
  void handle(const AbortConfirmed& body, const Inbound& from, Step step);
  /// A node whose certificate is revoked confirms no abort any more, until it is a member again: then it is owed the
  /// abort of every run that is still here.
  void handle(const PeerExpired& body, const Inbound& from, Step step);
  void handle(const PeerJoined& body, const Inbound& from, Step step);
  /// The same of nodes that the own router never met, or that were put out before this service began: at its welcome,
  /// and at each new list.
  void handle(const RevokedNodes& body, const Inbound& from, Step step);

  /// At a step's end: gives up what an aborted run owes to nodes whose certificate is revoked, and what a run that is
  /// being recovered waits for from them.
  void give_up_revoked(Run& run, Step step);
  /// At a step's end: confirms an abort once nothing of the run is under way here, and who passed it on has every
  /// result that it is owed.
  void confirm(Run& run, Step step) const;
  /// At a step's end: has this node's order signed when a failed task ends the run.
  void order_on_failure(Run& run, Step step) const;
  /// Keeps that order once it is signed; false if the record is no such order.
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

 private:
  [[nodiscard]] bool is_revoked(const Run& run, const std::string& member) const;

  std::string node_;
  const RunStore& runs_;
  const Executor& executor_;
  RunLookup& lookup_;
  RunJournal& journal_;
  std::set<std::string> revoked_;                ///< since the start of this service
  std::map<std::string, std::uint64_t> listed_;  ///< up to which serial, by the list in force
};

}  // namespace trb::scheduler
