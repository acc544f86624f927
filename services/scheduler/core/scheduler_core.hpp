// The scheduler: executes this node's tasks, passes the baton on, keeps what the fleet has signed about its runs.
// A pure state machine; README.md has its table of states and events. A message goes to its handler; what follows from
// the facts and the time is worked out at the end of every step, in advance().
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/base/steady_time.hpp"
#include "common/security/keys.hpp"
#include "services/scheduler/core/handlers/abort_handler.hpp"
#include "services/scheduler/core/handlers/baton_handler.hpp"
#include "services/scheduler/core/handlers/condition_handler.hpp"
#include "services/scheduler/core/handlers/decision_handler.hpp"
#include "services/scheduler/core/handlers/definition_handler.hpp"
#include "services/scheduler/core/handlers/end_handler.hpp"
#include "services/scheduler/core/handlers/pause_handler.hpp"
#include "services/scheduler/core/handlers/query_handler.hpp"
#include "services/scheduler/core/handlers/refusal_handler.hpp"
#include "services/scheduler/core/handlers/result_handler.hpp"
#include "services/scheduler/core/handlers/robot_handler.hpp"
#include "services/scheduler/core/handlers/route_handler.hpp"
#include "services/scheduler/core/robot_schedule.hpp"
#include "services/scheduler/core/run_archiver.hpp"
#include "services/scheduler/core/unattempted_results.hpp"

namespace trb {

namespace scheduler {

template <IsBody... First, IsBody... Second>
Takes<First..., Second...> operator+(Takes<First...>, Takes<Second...>);

/// The lists of several handlers, as one.
template <class... Handlers>
using TakenBy = decltype((... + typename Handlers::Taken{}));

}  // namespace scheduler

struct SchedulerSettings {
  std::string node;          ///< the own node's id
  FleetAuthority authority;  ///< opens the members' certificates
  bool has_robot = true;     ///< the node has a mode-adapter
  Bytes identity_key = {};   ///< the own certificate's; empty: unknown
};

class SchedulerCore : public Core {
 public:
  /// The archive must outlive it.
  SchedulerCore(SchedulerSettings settings, const scheduler::Archive& archive);

  /// What the handlers take, but for the answers to what this node has requested itself.
  using Taken = scheduler::TakenBy<scheduler::DefinitionHandler, scheduler::BatonHandler, scheduler::ResultHandler,
                                   scheduler::DecisionHandler, scheduler::AbortHandler, scheduler::PauseHandler,
                                   scheduler::EndHandler, scheduler::QueryHandler, scheduler::RobotHandler>;

  /// What the own router tells all its services, and this one wants to hear, too.
  static std::vector<std::string> subscriptions();

  /// Takes in what the journal held, in order, before on_welcome. Errors: those of scheduler::RunStore::apply.
  Status restore(std::span<const scheduler::JournalRecord> records);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;
  /// At how many runs the ends of its steps have looked.
  [[nodiscard]] std::uint64_t visits() const { return visits_; }

 private:
  using Run = scheduler::Run;
  using Step = scheduler::Step;

  [[nodiscard]] Step step_at(Now now, Outbox& out) { return {now, out, steady_.at(now)}; }
  void dispatch(const Inbound& message, Step step);
  /// To the first of them that takes it; false: none does.
  template <class... Handlers>
  bool offer(const Inbound& message, Step step, Handlers&... handlers);
  void handle_signed(const SignedRecord& record, const Inbound& from, Step step);
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

  /// The end of every step.
  void advance(Step step);
  void advance(Run& run, Step step);
  void keep_time(Step step);
  void report_lost_journal(Step step);
  void archive_runs(Step step);
  void touch_attempted();
  void plan_visit(Run& run) const;
  [[nodiscard]] std::optional<MonotonicTime> next_visit() const;

  SchedulerSettings settings_;
  SteadyTime steady_;
  scheduler::RunStore runs_;
  scheduler::Executor executor_;
  scheduler::Watchers watchers_;
  scheduler::LostJournal lost_;
  scheduler::RunLookup lookup_;
  scheduler::RunJournal journal_;

  scheduler::DefinitionHandler definitions_;
  scheduler::BatonHandler batons_;
  scheduler::ResultHandler results_;
  scheduler::DecisionHandler decisions_;
  scheduler::AbortHandler aborts_;
  scheduler::PauseHandler pauses_;
  scheduler::EndHandler ends_;
  scheduler::QueryHandler queries_;
  scheduler::RobotHandler robot_;
  scheduler::ConditionHandler conditions_;
  scheduler::AwaitedRobots robots_;
  scheduler::RouteHandler routes_;
  scheduler::RefusalHandler refusals_;

  scheduler::RobotSchedule schedule_;
  scheduler::UnattemptedResults unattempted_;
  scheduler::RunArchiver archiver_;

  std::optional<Now> last_;  ///< of the last step since the welcome
  UtcTime last_steady_{};
  std::optional<MonotonicTime> next_of_runs_;
  std::uint64_t visits_ = 0;
  std::optional<MonotonicTime> keep_time_at_;
};

}  // namespace trb
