// trb-resilience: watches the fleet and the own scheduler's runs, raises alerts, ranks who could take over, and turns a
// verdict into a signed decision.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/actor/core.hpp"
#include "common/actor/route_pages.hpp"
#include "common/actor/takes.hpp"
#include "services/resilience/core/alert_book.hpp"
#include "services/resilience/core/due_runs.hpp"
#include "services/resilience/core/open_tasks.hpp"
#include "services/resilience/core/overdue.hpp"
#include "services/resilience/core/proposals.hpp"
#include "services/resilience/core/run_watcher.hpp"
#include "services/resilience/core/standing.hpp"
#include "services/resilience/core/troubles.hpp"

namespace trb::resilience {

struct CoreSettings {
  std::string node;
  Role role{};  ///< only a cloud node decides: the router of a robot's node signs no decision
  ResilienceSettings resilience;
  HallPlaces places;
};

/// A decision as the database has it.
struct StoredDecision {
  SignedRecord record;
  bool delivered = false;  ///< the scheduler has it
};

// Its journal, as bodies: Alert (anew or instead of the one of that id), RunDecision (signed, not yet handed on),
// JournalDelivered with `what` "decision" (the scheduler has it) or "decision_dropped" (it never will: forget it).
class ResilienceCore final : public Core {
 public:
  explicit ResilienceCore(CoreSettings settings) : settings_(std::move(settings)) {}

  using Taken = Takes<AlertListRequest, AlertDecide>;  ///< `history_list` is its shell's
  /// Information that the service wants a copy of.
  static std::vector<std::string> hears();

  void restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  /// Its changes are written by who runs the core.
  Fleet& fleet() { return fleet_; }

 private:
  /// Answers of robots come in a crowd: so long after the first, proposals follow those that are there.
  static constexpr Duration kCrowd = std::chrono::milliseconds(100);

  /// What is under way of an alert; lost at a restart but for `record`.
  struct Work {
    std::optional<MonotonicTime> grown_at;  ///< the alert's tasks, or itself
    std::optional<MonotonicTime> ranked_at;
    std::optional<MonotonicTime> asked_at;                  ///< the candidates, for their values
    std::set<std::pair<std::string, std::string>> awaited;  ///< robot, value
    std::optional<MonotonicTime> heard_at;                  ///< the first answer that the proposals do not follow yet
    std::optional<MonotonicTime> releasing_since;
    std::vector<std::string> bounded;  ///< who would be proposed but for a bound
    Backoff release;
    Backoff sign;
    Backoff hand;
    Backoff mend;
    std::optional<MonotonicTime> taken_at;  ///< when the robot's node answered that it is in use
    std::string refusal_to_mend;            ///< the node's own
    std::optional<MonotonicTime> refused_at;
    bool mended = false;                 ///< the robot's node has taken into use what a person says is repaired
    Bytes signing;                       ///< what the router is asked to sign
    std::optional<SignedRecord> record;  ///< the decision, or the order to abort
    std::uint32_t epoch = 0;             ///< of the decision
    std::string refusal;                 ///< the scheduler's
    std::string asks_for;                ///< why the policy keeps out
  };

  // what is heard (resilience_core.cpp)
  void on_request(const Inbound& message, Now now, Outbox& out);
  void on_information(const Inbound& message, Now now, Outbox& out);
  void on_answer(const Inbound& message, Now now, Outbox& out);
  void hear(const RobotFault& fault, const std::string& robot, Now now, Outbox& out);
  void take_page(const RouteTable& page, Now now, Outbox& out);
  void hear(const RouteTable& table, Now now, Outbox& out);
  void judge_all(Now now);
  void hear(const Nack& nack, Now now, Outbox& out);
  void look_at_robot(const std::string& robot, Now now, bool expired = false);
  void ask_routes(Now now, Duration at_most_every);
  void look(Now now, Outbox& out);
  void settle(Now now, Outbox& out);

  // detecting.cpp
  void look_at_runs(Now now, Outbox& out);
  void look_at_run(const WatchedRun& run, Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_moment(const WatchedRun& run, Now now) const;
  void count_tasks(const std::string& run);
  bool meet(const WatchedRun& run, const Trouble& trouble, Now now, Outbox& out);
  [[nodiscard]] static Alert alert_of(const WatchedRun& run, const std::string& robot, Now now);
  Alert* raise(Alert alert, Now now, Outbox& out);
  void tell_standing(Now now, Outbox& out);
  Alert* raise_lone(const Standing::Key& key, Now now, Outbox& out);
  void close(Alert& alert, const std::string& why, Outbox& out);

  // mending.cpp
  void mend(const Alert& alert, const std::string& why, Now now);
  [[nodiscard]] std::vector<std::string> told_broken(const Alert& alert) const;
  [[nodiscard]] bool waits_for_mending(Alert& alert, Now now, Outbox& out);
  void hear_taken(const std::string& from, Now now);
  void hear_unmended(const Nack& nack, const std::string& from, Now now, Outbox& out);
  void unmended(Alert& alert, const std::string& why, Outbox& out);

  // proposing.cpp
  void look_at_alerts(Now now, Outbox& out);
  void look_at_open(Alert& alert, Now now, Outbox& out);
  [[nodiscard]] std::string run_over_text(const std::string& run) const;
  void look_at_notice(Alert& alert, const WatchedRun& run, Now now);
  void look_at_lone(Alert& alert, Now now, Outbox& out);
  void propose(Alert& alert, const WatchedRun& run, Now now);
  void ask_values(const Alert& alert, Now now, Outbox& out);
  void hear(const Opaque& value, const std::string& robot, Now now, Outbox& out);
  void hear(const SensorReading& reading, const std::string& robot, Now now, Outbox& out);
  void note_answer(Now now, Outbox& out);
  void follow_answers(Alert& alert, Now now, Outbox& out);
  [[nodiscard]] bool is_out_of_bounds(const WatchedRun& run, std::size_t task, const RobotRecord& robot) const;
  void refused_reading(const std::string& robot);
  void answered(const std::string& robot, const std::string& value);
  [[nodiscard]] bool is_stale(const Alert& alert) const;

  // policy.cpp
  void try_policy(Alert& alert, Now now, Outbox& out);
  [[nodiscard]] std::string why_moved_enough(const Alert& alert) const;
  [[nodiscard]] std::string why_ask(const Alert& alert, Now now);
  [[nodiscard]] std::string why_wait(const Alert& alert, Now now);
  [[nodiscard]] static std::string awaits(const Work& work, Duration patience, Now now);
  [[nodiscard]] std::string open_text(const Alert& alert) const;
  [[nodiscard]] bool decides(const Alert& alert) const;

  // verdicts.cpp
  void handle(const AlertListRequest& body, const Inbound& from, Now now, Outbox& out);
  void handle(const AlertDecide& body, const Inbound& from, Now now, Outbox& out);
  Result<std::string> decide(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_alert(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  [[nodiscard]] bool is_stuck(const Alert& alert, Now now);
  [[nodiscard]] Alert* alert_of_fault(const Alert& alert);
  Result<std::string> decide_lone(Alert& alert, const AlertDecide& body, Now now, Outbox& out);

  // verdict_checks.cpp
  [[nodiscard]] Status check_decider(const Alert& alert, const WatchedRun* run, const AlertDecide& body) const;
  [[nodiscard]] Status check_override(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] Status take_proposal(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now);
  [[nodiscard]] Status take_override(Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] Status check_word(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] Status check_retry(const Alert& alert, Now now) const;
  [[nodiscard]] static Status check_retry_of(const Alert& alert, const WatchedRun& run);
  [[nodiscard]] Status check_bounds(const Alert& alert, const WatchedRun& run);
  [[nodiscard]] Status shape(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now);
  [[nodiscard]] static Status narrow(Alert& alert, const AlertDecide& body, const WatchedRun& run);

  // asking.cpp
  [[nodiscard]] Result<const WatchedRun*> choose_run(const std::string& beginning) const;
  [[nodiscard]] Result<Alert*> alert_of_tasks(const WatchedRun& run, const std::vector<std::string>& tasks);
  Result<std::string> decide_tasks(const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_anew(Alert fresh, const AlertDecide& body, Now now, Outbox& out);

  // lateness.cpp
  [[nodiscard]] std::vector<Trouble> overdue_troubles(const WatchedRun& run, Now now);
  void skip_unbegun(const WatchedRun& run, Now now, Outbox& out);

  // deciding.cpp
  void advance(Alert& alert, Now now, Outbox& out);
  void advance_abort(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void advance_decision(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void hand_on(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void begin_signing(Alert& alert, const WatchedRun& run, std::vector<TaskRuling> rulings, Now now, Outbox& out);
  [[nodiscard]] bool take_turn(const std::string& alert, Now now);
  void on_signed(const SignedRecord& record, Outbox& out);
  void record_handed(const Alert& alert, const std::string& what, Outbox& out) const;
  void finish(Alert& alert, Outbox& out);
  void reopen(Alert& alert, const std::string& why, Outbox& out);
  [[nodiscard]] std::string busy_with(const Alert& alert);

  CoreSettings settings_;
  Fleet fleet_;
  RunWatcher watcher_;
  Presence presence_;
  RoutePages routes_;
  AlertBook book_;
  std::map<std::string, Work, std::less<>> works_;  ///< by alert
  std::map<std::string, SignedRecord, std::less<>> certificates_;
  OpenTasks open_tasks_;
  Standing standing_;
  Overdue overdue_;
  DueRuns due_runs_;
  std::string handed_;  ///< the alert whose decision or order was sent last
  bool welcomed_ = false;
  bool stirred_ = true;        ///< something has changed that alerts may depend on
  bool routes_heard_ = false;  ///< before, nobody is known to be reached: nothing is judged
  std::optional<MonotonicTime> looked_at_;
  std::optional<MonotonicTime> look_at_;
  std::optional<MonotonicTime> ask_routes_at_;
  std::optional<MonotonicTime> asked_routes_;
};

}  // namespace trb::resilience
