// A scheduler that keeps its journal in memory, and what must hold of it whatever it is told: it commands no task
// without a valid chain, journals only what is proven, counts what it refuses, and can read its journal again.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/test/memory_archive.hpp"
#include "tests/fuzz/run_proof.hpp"

namespace trb::fuzz {

constexpr std::uint64_t kInstance = 100;

/// The scheduler of "a", which knows the run or not yet; its robot is ready.
class SchedulerUnderTest {
 public:
  explicit SchedulerUnderTest(bool knows) : core_({"a", Keys::get().authority, true}, archive_) {
    if (knows) journal_.push_back(scheduler::JournalRun{Keys::get().start, false});
    require(core_.restore(journal_.records()).ok(), "a journal is taken in");
    Outbox out;
    core_.on_welcome({"a", Role::robot, 1}, now_, out);
    take(out);
  }

  Outbox hear(const std::string& from, Body body, std::uint64_t reply_to = 0) {
    const MessageType type = is_command(body) ? MessageType::command : MessageType::information;
    Outbox out;
    core_.on({type, from, "a", ++count_, reply_to, 0, kDefaultRemainingMs, body}, now_, out);
    take(out);
    const bool answered = from == "a" || !is_command(body) || !out.sends.empty() || holds_alternative<Results>(body) ||
                          holds_alternative<RunAbort>(body);
    require(answered || !out.counts.empty(), "a peer's command is answered or counted");
    return out;
  }
  void ready(bool is_ready) { hear("a", AdapterState{kInstance, is_ready ? "ONLINE" : "OFFLINE", false, false, {}}); }
  void pass(double s) {
    now_ = {now_.mono + seconds(s), now_.utc + seconds(s)};
    Outbox out;
    core_.tick(now_, out);
    take(out);
  }
  /// The router and the robot do what they were last ordered to do.
  void serve(bool well, TaskOutcome outcome) {
    if (sign_) {
      SignedRecord record = Keys::get().sign("a", sign_->kind, sign_->payload.bytes);
      if (!well) record.signature.bytes[0] = static_cast<char>(record.signature.bytes[0] ^ 1);
      hear("a", record);
    }
    if (execute_) hear("a", Outcome{execute_->key, kInstance, outcome, "", "7", 1});
  }
  void end() {
    SchedulerCore again({"a", Keys::get().authority, true}, archive_);
    require(again.restore(journal_.records()).ok(), "what was journaled is taken in again");
  }
  [[nodiscard]] const Proof& proof() const { return proof_; }

 private:
  static bool is_command(const Body& body) {
    return holds_alternative<Baton>(body) || holds_alternative<Results>(body) || holds_alternative<RunDecision>(body) ||
           holds_alternative<RunPause>(body) || holds_alternative<RunAbort>(body) ||
           holds_alternative<ReleaseTasks>(body);
  }
  void take(const Outbox& out) {
    for (const Journal& one : out.journal) {
      const auto record = scheduler::to_journal_record(one.record);
      require(record.ok(), "only facts are journaled");
      journal_.commit(*record, archive_);
      proof_.take(*record);
    }
    bool refused = false;
    for (const Send& send : out.sends) {
      refused = refused || holds_alternative<Nack>(send.body);
      if (const auto* is = get_if<SignRequest>(&send.body)) sign_ = *is;
      if (const auto* is = get_if<Execute>(&send.body)) {
        proof_.command(*is);
        execute_ = *is;
      }
    }
    const bool counted = std::any_of(out.counts.begin(), out.counts.end(),
                                     [](const std::string& name) { return name.starts_with("refused."); });
    require(!refused || counted, "what is refused is counted");
  }

  scheduler::test::MemoryArchive archive_;
  SchedulerCore core_;
  Now now_{{1'000'000'000}, {kEpoch}};
  std::uint64_t count_ = 0;
  scheduler::test::MemoryJournal journal_;
  Proof proof_;
  std::optional<SignRequest> sign_;
  std::optional<Execute> execute_;
};

}  // namespace trb::fuzz
