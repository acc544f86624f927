// Conditions of tasks: this node searches the sensor's node, reads the sensor, and has its choice signed.
#pragma once

#include "common/actor/takes.hpp"
#include "proto/bodies/link.hpp"
#include "services/scheduler/core/run_journal.hpp"

namespace trb::scheduler {

class ConditionHandler {
 public:
  /// Answers to requests of this node.
  using Answers = Takes<SensorReading>;

  /// All must outlive it.
  ConditionHandler(std::string node, const RunStore& runs, RunJournal& journal)
      : node_(std::move(node)), runs_(runs), journal_(journal) {}

  void handle(const SensorReading& body, const Inbound& from, Step step);
  /// Of the own router: who has the sensors.
  void on_routes(const RouteTable& table, Step step) const;
  /// A sensor's node refuses or does not answer.
  void on_refusal(const Nack& nack, const Inbound& from, Step step);

  /// At a step's end: requests the values for which the run's conditions wait.
  void inquire(Run& run, Step step) const;
  /// Keeps a choice once it is signed; false if it is another record.
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

 private:
  void choose(const SensorReading& reading, const std::string& node, const Run& run, Inquiry& inquiry, Step step) const;
  void notify_wait(const Run& run, TaskIndex task, const std::string& what, Step step) const;

  std::string node_;
  const RunStore& runs_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
