// The scheduler: executes this node's tasks, passes the baton on, keeps what the fleet says of its runs.
// A pure state machine; README.md has its table of states and events.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/actor/route_pages.hpp"
#include "common/actor/takes.hpp"
#include "common/base/steady_time.hpp"
#include "common/security/keys.hpp"
#include "services/scheduler/core/archive.hpp"
#include "services/scheduler/core/deferred_messages.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/view.hpp"
#include "services/scheduler/core/watchers.hpp"

namespace trb {

struct SchedulerSettings {
  std::string node;          ///< the own node's id
  FleetAuthority authority;  ///< opens the members' certificates
  bool has_robot = true;     ///< the node has a mode-adapter
};

class SchedulerCore : public Core {
 public:
  /// The archive must outlive it.
  SchedulerCore(SchedulerSettings settings, const scheduler::Archive& archive);

  using Taken =
      Takes<RunSubmit, Baton, BatonJournaled, NeedDefinition, Definition, NeedResults, Results, ResultsJournaled,
            TaskProgress, RunAbort, AbortConfirmed, RunQuery, RunListRequest, AdapterState, ExecutionState, Outcome,
            RunDecision, DecisionJournaled, ReleaseTasks, RunPause, PauseJournaled, RunWatch, RunOver, NeedEnd>;

  /// Takes in what the journal held, in order, before on_welcome. Errors: those of scheduler::RunStore::apply.
  Status restore(std::span<const Body> records);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

 private:
  /// To what it has asked itself.
  using Answers = Takes<SignedRecord, RouteTable, SensorReading, Ack, Nack>;
  using Run = scheduler::Run;
  struct Step {
    Now now;
    Outbox& out;
    UtcTime steady;  ///< what times to live count by
    [[nodiscard]] scheduler::Clock clock() const { return {now.mono, steady}; }
  };

  // One handler a body; on_run.cpp, on_results.cpp, on_abort.cpp, on_robot.cpp, on_sensor.cpp, on_decision.cpp,
  // on_pause.cpp, on_end.cpp, on_query.cpp.
  void handle(const RunSubmit& body, const Inbound& from, Step step);
  void handle(const Baton& body, const Inbound& from, Step step);
  void handle(const BatonJournaled& body, const Inbound& from, Step step);
  void handle(const NeedDefinition& body, const Inbound& from, Step step);
  void handle(const Definition& body, const Inbound& from, Step step);
  void handle(const NeedResults& body, const Inbound& from, Step step);
  void handle(const Results& body, const Inbound& from, Step step);
  void handle(const ResultsJournaled& body, const Inbound& from, Step step);
  void handle(const TaskProgress& body, const Inbound& from, Step step);
  void handle(const RunAbort& body, const Inbound& from, Step step);
  void handle(const AbortConfirmed& body, const Inbound& from, Step step);
  void handle(const RunDecision& body, const Inbound& from, Step step);
  void handle(const DecisionJournaled& body, const Inbound& from, Step step);
  void handle(const ReleaseTasks& body, const Inbound& from, Step step);
  void handle(const RunPause& body, const Inbound& from, Step step);
  void handle(const PauseJournaled& body, const Inbound& from, Step step);
  void handle(const RunOver& body, const Inbound& from, Step step);
  void handle(const NeedEnd& body, const Inbound& from, Step step);
  void handle(const RunWatch& body, const Inbound& from, Step step);
  void handle(const RunQuery& body, const Inbound& from, Step step);
  void handle(const RunListRequest& body, const Inbound& from, Step step);
  void handle(const AdapterState& body, const Inbound& from, Step step);
  void handle(const ExecutionState& body, const Inbound& from, Step step);
  void handle(const Outcome& body, const Inbound& from, Step step);
  void handle(const SignedRecord& body, const Inbound& from, Step step);
  void handle(const RouteTable& body, const Inbound& from, Step step);
  void handle(const SensorReading& body, const Inbound& from, Step step);
  void handle(const Ack& body, const Inbound& from, Step step);
  void handle(const Nack& body, const Inbound& from, Step step);
  void dispatch(const Inbound& message, Step step);

  /// The negative answer, counted; information is only counted.
  void refuse(const Inbound& from, const Error& error, Step step);
  /// Refuses what is about a run that is over; who may not know yet is told that it has FINISHED.
  void refuse_over(const std::string& run, const scheduler::Over& over, const Inbound& from, Step step);
  /// The run that a peer's message is about, or nullptr after a refusal.
  Run* run_for(const std::string& run, const Inbound& from, Step step);
  /// run_for; but what a peer says of an unknown run is kept, and the peer is asked for the definition.
  Run* run_or_defer(const std::string& run, const Blob& digest, const Inbound& from, Step step);
  void install(Run run, const SignedRecord& start, bool submitted_here, Step step);
  void keep_result(Run& run, scheduler::HeldResult held, Step step);
  void keep_choice(Run& run, scheduler::HeldChoice held, Step step);
  /// Keeps a choice, a result without an attempt, or an order to abort, that was being signed; false if the record is
  /// none.
  bool keep_signed_choice(Run& run, const SignedRecord& record, Step step);
  bool keep_signed_skip(Run& run, const SignedRecord& record, Step step);
  bool keep_signed_abort(Run& run, const SignedRecord& record, Step step);
  bool keep_signed_hold(Run& run, const SignedRecord& record, Step step);
  bool keep_signed_end(Run& run, const SignedRecord& record, Step step);
  /// Orders that came with a definition or a baton. Error: of the first bad one; none is taken then.
  Status take_orders(Run& run, const std::vector<SignedRecord>& orders, Step step);
  Status keep_abort(Run& run, const SignedRecord& order, bool here, Step step);
  Status keep_pause(Run& run, const SignedRecord& order, bool here, Step step);
  void keep_end(Run& run, const SignedRecord& end, Step step);
  /// Keeps a message that is of a later epoch than is known, and asks its sender for the decisions; false if it is not.
  bool defer_for_decisions(Run& run, std::uint32_t epoch, const Inbound& from, Step step);
  void keep_decision(Run& run, const SignedRecord& record, bool here, Step step);
  Status take_decisions(Run& run, const std::vector<SignedRecord>& records, Step step);
  /// Hands out what waited for a definition or for decisions.
  void hand_out_deferred(const std::string& run, Step step);
  void take_more_decisions(Run& run, const Definition& body, const Inbound& from, Step step);
  /// Logs that the own router has signed something else than was asked for, which is asked for again; true.
  bool wrong_signature(const Error& error, Step step);
  void refused_reading(const Nack& nack, const Inbound& from, Step step);
  void note_refusal(const Nack& nack, const Inbound& from);
  void ask_newer(const Nack& nack, const Inbound& from, Step step);
  Status check_baton(const Run& run, const Baton& baton, Step step) const;
  /// Journals that another node has what it was owed.
  void delivered(Run& run, scheduler::DeliveryKind kind, const Inbound& from, std::vector<TaskIndex> tasks,
                 std::uint32_t epoch, Step step);

  // The end of every step: advance.cpp, ending.cpp, choosing.cpp, passing.cpp.
  [[nodiscard]] Step step_at(Now now, Outbox& out) { return {now, out, steady_.at(now)}; }
  void advance(Step step);
  void keep_time(Step step);
  void look_at(Run& run, Step step);
  [[nodiscard]] bool runs(const Run& run, TaskIndex task) const;
  [[nodiscard]] bool is_late(const Run& run, TaskIndex task, Step step) const;
  [[nodiscard]] std::string late_text(const Run& run, TaskIndex task) const;
  [[nodiscard]] std::vector<Run*> by_turn() const;
  void hold_for_doubles(Run& run, Step step);
  void ask_end(Run& run, Step step);
  void end_runs(Step step);
  [[nodiscard]] bool is_over(const Run& run, Step step) const;
  void put_into_archive(Run& run, Step step);
  void permit_attempt(Step step);
  void resume_attempt();
  void start_next(Step step);
  void start(Run& run, TaskIndex task, Step step);
  [[nodiscard]] bool may_start(const Run& run, UtcTime steady) const;
  void tell_progress(const Run& run, const AttemptKey& key, TaskState state, Step step);
  void decide(Run& run, Step step);
  void inquire(Run& run, Step step);
  void say_results(Run& run, bool open, Step step);
  void abort_on_failure(Run& run, Step step);
  [[nodiscard]] RunTable open_runs(Step step) const;
  void tell_watchers(Step step);
  void choose_by(const SensorReading& reading, const std::string& node, Run& run, scheduler::Inquiry& inquiry,
                 Step step);
  void tell_waiting(const Run& run, TaskIndex task, const std::string& what, Step step);
  void pass_overdue(Run& run, Step step);
  void pass_on(Run& run, Step step);
  void send(const Run& run, const scheduler::PendingDelivery& delivery, Step step);
  void ask_needs(Run& run, Step step);
  void confirm_abort(Run& run, Step step);

  SchedulerSettings settings_;
  const scheduler::Archive& archive_;
  SteadyTime steady_;
  RoutePages routes_;  ///< of the own router
  scheduler::RunStore runs_;
  scheduler::Executor executor_;
  scheduler::DeferredMessages deferred_;
  scheduler::Watchers watchers_;
  scheduler::LostJournal lost_;
  bool handing_out_ = false;
  std::optional<Now> last_;  ///< of the last step since the welcome
  UtcTime last_steady_{};
  std::optional<MonotonicTime> keep_time_at_;
};

}  // namespace trb
