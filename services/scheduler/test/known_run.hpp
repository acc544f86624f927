// One run as one node knows it, and everybody's signature on what is said of it: for tests of a run's parts and of the
// handlers, by hand and without a fleet that runs.
#pragma once

#include <string>
#include <vector>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"
#include "services/scheduler/test/memory_archive.hpp"
#include "services/scheduler/test/scenarios.hpp"
#include "services/scheduler/test/signers.hpp"

namespace trb::scheduler::test {

class KnownRun {
 public:
  /// As that node knows it, with so much room for open runs.
  explicit KnownRun(const Scenario& scenario, const std::string& node = "ur3",
                    std::size_t most_bytes = RunStore::kMostBytes);

  // Signed records of this run.
  [[nodiscard]] SignedRecord result(const std::string& task, const std::string& robot, TaskOutcome outcome,
                                    std::uint32_t attempt = 1, const std::string& data = "") const;
  [[nodiscard]] SignedRecord decision(std::vector<TaskRuling> rulings, const std::string& by = "cloud") const;
  [[nodiscard]] SignedRecord pause(std::uint32_t number, bool paused, std::vector<std::string> doubles = {},
                                   const std::string& by = "cloud") const;
  [[nodiscard]] SignedRecord abort(const std::string& by = "cloud") const;
  [[nodiscard]] SignedRecord end(const std::string& by = "cloud") const;
  [[nodiscard]] SignedRecord choice(const std::string& by, const std::string& task, double degrees) const;

  /// Takes a result in, as from the journal.
  void add(const SignedRecord& result);
  /// A task's result of its robot.
  void finish(const std::string& task);
  void decide(std::vector<TaskRuling> rulings);

  /// A message of that node to this one.
  [[nodiscard]] Inbound from(const std::string& node, MessageType type, Body body, std::uint64_t reply_to = 0) const;
  /// Hands a body to a handler, in a step of its own; its effects.
  template <class Handler, class Message>
  Outbox send(Handler& handler, const std::string& node, const Message& body, MessageType type = MessageType::command,
              std::uint64_t reply_to = 0) {
    Outbox out;
    handler.handle(body, from(node, type, body, reply_to), step(out));
    return out;
  }
  [[nodiscard]] Step step(Outbox& out) const { return {now, out, now.utc}; }
  void pass(double time_s) { now = {now.mono + seconds(time_s), now.utc + seconds(time_s)}; }
  [[nodiscard]] TaskIndex task(const std::string& id) const { return *run().index_of(id); }
  [[nodiscard]] Run& run() const { return *runs.find(kKnownRun); }

  Signers signers;
  std::string self;
  SignedRecord start;
  Now now;
  MemoryArchive archive;
  RunStore runs;
  Executor executor;
  RunLookup lookup;
  LostJournal lost;
  RunJournal journal;
};

/// The codes of the negative answers among the effects, in order.
std::vector<std::string> nacks(const Outbox& out);
/// Who is sent a body of that type, in order.
template <class T>
std::vector<std::string> targets(const Outbox& out) {
  std::vector<std::string> to;
  for (const Send& send : out.sends) {
    if (holds_alternative<T>(send.body)) to.push_back(send.target);
  }
  return to;
}
/// The record as the router gives it: what was asked to be signed.
SignedRecord signed_by(const Signers& signers, const std::string& node, const Outbox& out);

}  // namespace trb::scheduler::test
