#include "services/scheduler/test/known_run.hpp"

#include <doctest/doctest.h>

namespace trb::scheduler::test {

KnownRun::KnownRun(const Scenario& scenario, const std::string& node, std::size_t most_bytes)
    : self(node),
      start(signers.start(scenario)),
      now(Signers::kNow),
      runs(self, signers.authority(), most_bytes),
      executor(self),
      lookup(self, runs, archive),
      journal(self, runs, lost) {
  auto opened = runs.open(start);
  REQUIRE_MESSAGE(opened.ok(), (opened ? "" : opened.error().text()));
  runs.add(std::move(*opened));
}

SignedRecord KnownRun::result(const std::string& task, const std::string& robot, TaskOutcome outcome,
                              std::uint32_t attempt, const std::string& data) const {
  TaskResult out;
  out.key = {kKnownRun, task, 1, attempt};
  out.digest = run().definition().start().digest;
  out.epoch = run().epochs().current();
  out.robot = robot;
  out.outcome = outcome;
  out.data = data;
  return signers.sign(robot, kSignedResult, encode(out));
}

SignedRecord KnownRun::decision(std::vector<TaskRuling> rulings, const std::string& by) const {
  const Epochs& epochs = run().epochs();
  Decision out;
  out.run = kKnownRun;
  out.digest = run().definition().start().digest;
  out.epoch = epochs.current() + 1;
  if (!epochs.records().empty()) out.previous.bytes = digest(epochs.records().back().payload.bytes);
  out.by = by;
  out.tasks = std::move(rulings);
  return signers.sign(by, kSignedDecision, encode(out));
}

SignedRecord KnownRun::pause(std::uint32_t number, bool paused, std::vector<std::string> doubles,
                             const std::string& by) const {
  const PauseOrder out{kKnownRun, number, paused, by, "", 1, std::move(doubles)};
  return signers.sign(by, kSignedRunPause, encode(out));
}

SignedRecord KnownRun::abort(const std::string& by) const {
  return signers.sign(by, kSignedRunAbort, encode(AbortOrder{kKnownRun, by, "", 1}));
}

SignedRecord KnownRun::end(const std::string& by) const {
  const RunEnd out{kKnownRun, run().definition().start().digest, by, RunState::finished, 1};
  return signers.sign(by, kSignedRunEnd, encode(out));
}

SignedRecord KnownRun::choice(const std::string& by, const std::string& task, double degrees) const {
  Choice out;
  out.run = kKnownRun;
  out.digest = run().definition().start().digest;
  out.epoch = run().epochs().current();
  out.by = by;
  out.node = "conveyor";
  out.reading = {"temperature", "28-01", "degC", false, degrees, "", 1, 0, "good", 0, 0};
  const Condition& condition = run().tasks()[*run().index_of(task)].when.front();
  out.tasks.push_back({task, 1, holds(condition, out.reading)});
  return signers.sign(by, kSignedChoice, encode(out));
}

void KnownRun::add(const SignedRecord& result) {
  const Status applied = run().apply(JournalResult{result});
  REQUIRE_MESSAGE(applied.ok(), (applied ? "" : applied.error().text()));
}

void KnownRun::finish(const std::string& task) {
  add(result(task, run().epochs().robot_of(*run().index_of(task)), TaskOutcome::finished));
}

void KnownRun::decide(std::vector<TaskRuling> rulings) {
  const Status applied = run().apply(JournalDecision{decision(std::move(rulings)), false});
  REQUIRE_MESSAGE(applied.ok(), (applied ? "" : applied.error().text()));
}

Inbound KnownRun::from(const std::string& node, MessageType type, Body body, std::uint64_t reply_to) const {
  return {type, node, self, 77, reply_to, 0, 1000, std::move(body)};
}

std::vector<std::string> nacks(const Outbox& out) {
  std::vector<std::string> codes;
  for (const Nack& nack : sent<Nack>(out)) codes.push_back(nack.code);
  return codes;
}

SignedRecord signed_by(const Signers& signers, const std::string& node, const Outbox& out) {
  const auto requests = sent<SignRequest>(out);
  REQUIRE(requests.size() == 1);
  return signers.sign(node, requests.front().kind, requests.front().payload.bytes);
}

}  // namespace trb::scheduler::test
