// Reports of the own mode-adapter on the robot and its attempt, and the router's signature of the attempt's result.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/run_journal.hpp"

namespace trb::scheduler {

class RobotHandler {
 public:
  using Taken = Takes<AdapterState, ExecutionState, Outcome>;
  /// Answers to requests of this node.
  using Answers = Takes<Ack>;

  /// All must outlive it.
  RobotHandler(std::string node, const RunStore& runs, Executor& executor, LostJournal& lost, RunJournal& journal)
      : node_(std::move(node)), runs_(runs), executor_(executor), lost_(lost), journal_(journal) {}

  void handle(const AdapterState& body, const Inbound& from, Step step);
  void handle(const ExecutionState& body, const Inbound& from, Step step);
  void handle(const Outcome& body, const Inbound& from, Step step);
  void handle(const Ack& body, const Inbound& from, Step step);

  /// Keeps the signed result of the attempt, or gives the attempt up, if the run knows other keys of this node; false
  /// if it is another record.
  bool keep_signed(const SignedRecord& record, const Inbound& from, Step step);

 private:
  void confirm_old(const Outcome& body, Step step);
  void on_wrong_signature(Run& run, const Error& error, Step step);

  std::string node_;
  const RunStore& runs_;
  Executor& executor_;
  LostJournal& lost_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
