// The alerts and their work in progress: how an alert is raised, ends, or is opened again.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/actor/outbox.hpp"
#include "services/resilience/core/alert_book.hpp"
#include "services/resilience/core/alert_text.hpp"
#include "services/resilience/core/inquiry.hpp"
#include "services/resilience/core/repair_report.hpp"
#include "services/resilience/core/signing.hpp"
#include "services/resilience/core/situation.hpp"

namespace trb::resilience {

/// An alert's work in progress; lost at a restart, except for a signed record.
struct AlertWork {
  Inquiry inquiry;
  RepairReport repair;
  Signing signing;
  std::optional<MonotonicTime> grown_at;  ///< when the alert was raised, or its tasks grew
  std::string asks_for;                   ///< why the policy leaves it to people
};

/// A decision as the database stores it.
struct StoredDecision {
  SignedRecord record;
  bool delivered = false;  ///< the scheduler has it
};

enum class DecisionEnd : std::uint8_t {
  handed = 0,  ///< the scheduler has it
  dropped      ///< it never will: forget it
};

/// A record: what became of a signed decision.
struct DecisionOver {
  std::string run;
  std::uint32_t epoch = 1;
  DecisionEnd end{};
};

/// A record: the run is over, and no decision on it is needed any more.
struct DecisionsOver {
  std::string run;
};

/// An alert of a run and a robot, without what may change: the cause, and what follows from it.
[[nodiscard]] Alert alert_of(const WatchedRun& run, const std::string& robot, Now now);

class AlertLifecycle {
 public:
  explicit AlertLifecycle(Situation& situation)
      : situation_(situation), book_([this](const std::string& run) { return submitter_of(run); }) {}

  void restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions);
  /// Records a signed decision. The database takes no other one of that run and epoch.
  void keep(const Decision& decision, const SignedRecord& record, Outbox& out);
  [[nodiscard]] bool has_decision(const std::string& run, std::uint32_t epoch) const {
    return decided_.contains({run, epoch});
  }

  /// The scheduler has reported the run's end.
  void note_over(const std::string& run);
  /// Forgets the decisions of runs that are over, once no open alert is about the run.
  void forget_over(Outbox& out);

  AlertBook& book() { return book_; }
  /// Those that are not over, by time, then id.
  std::vector<Alert*> open() { return book_.open(); }
  AlertWork& work(std::string_view alert);
  [[nodiscard]] const AlertWork* find_work(std::string_view alert) const;
  /// Drops the work in progress.
  void reset_work(std::string_view alert) { works_.erase(std::string(alert)); }
  /// A robot has answered a request that was made for alerts.
  void on_answer(const std::string& robot, const std::string& value);
  /// When something is sent again, or proposals follow new values.
  [[nodiscard]] std::optional<MonotonicTime> next(Now now) const;

  /// nullptr: too many are open.
  Alert* raise(Alert fresh, Now now, Outbox& out);
  /// Removes an alert that was never recorded.
  void drop(const std::string& alert);
  /// Ends an alert on which nothing was decided.
  void close(Alert& alert, const std::string& why, Outbox& out);
  /// The scheduler has the decision.
  void finish(Alert& alert, Outbox& out);
  /// The decision cannot be carried out: the alert is as before the verdict, and shows why. `for_good`: the policy does
  /// not try it again.
  void reopen(Alert& alert, const std::string& why, Outbox& out, bool for_good = false);

 private:
  void record_end(const Alert& alert, DecisionEnd end, Outbox& out);
  [[nodiscard]] std::string_view submitter_of(const std::string& run) const;
  [[nodiscard]] bool is_trusted(const std::string& run) const;

  Situation& situation_;
  AlertBook book_;
  std::map<std::string, AlertWork, std::less<>> works_;
  std::set<std::pair<std::string, std::uint32_t>> decided_;  ///< the database's decisions, by run and epoch
  std::set<std::string> over_;                               ///< runs of those that are over
};

}  // namespace trb::resilience
