// Refusals of other nodes and services.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/handlers/baton_handler.hpp"
#include "services/scheduler/core/handlers/condition_handler.hpp"

namespace trb::scheduler {

class RefusalHandler {
 public:
  /// Answers to requests of this node.
  using Answers = Takes<Nack>;

  /// All must outlive it.
  RefusalHandler(std::string node, const RunStore& runs, Executor& executor, ConditionHandler& conditions,
                 BatonHandler& batons, RunJournal& journal)
      : node_(std::move(node)),
        runs_(runs),
        executor_(executor),
        conditions_(conditions),
        batons_(batons),
        journal_(journal) {}

  void handle(const Nack& body, const Inbound& from, Step step);

 private:
  void note_recovery(const Nack& nack, const Inbound& from, Step step) const;
  void give_up_delivery(const Nack& nack, const Inbound& from, Step step) const;

  std::string node_;
  const RunStore& runs_;
  Executor& executor_;
  ConditionHandler& conditions_;
  BatonHandler& batons_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
