// Watches the own scheduler's runs: renews the watch, and requests what has changed.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "common/actor/outbox.hpp"
#include "services/resilience/core/resend.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

class RunWatcher {
 public:
  using Runs = std::map<std::string, WatchedRun, std::less<>>;

  void on_welcome(std::string node);
  void on(const RunTable& table, Now now);
  void on(const RunChanged& changed, Now now);
  void on(const RunView& view);
  void on(const Definition& definition);
  void on_nack(const Nack& nack, Now now, Outbox& out);
  /// Sends the requests that are due.
  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

  /// The runs that are not over, by id.
  [[nodiscard]] const Runs& runs() const { return runs_; }
  [[nodiscard]] const WatchedRun* find(std::string_view run) const;
  /// How the run has ended, if that was reported lately; else nothing.
  [[nodiscard]] std::optional<RunState> ended(std::string_view run) const;
  /// Has a table come since the welcome? Then a run that is not in runs() is over, or not known to this scheduler.
  [[nodiscard]] bool has_table() const { return has_table_; }
  /// Requests the run's view anew: something was sent to the scheduler, or the view is too old to act on.
  void refresh(std::string_view run);
  /// The runs that are new, have changed or have ended since the last call.
  std::set<std::string> take_changed() { return std::exchange(changed_, {}); }
  /// The runs whose end the scheduler has reported since the last call.
  std::set<std::string> take_timed() { return std::exchange(timed_, {}); }

 private:
  struct Asking {
    bool view_wanted = true;
    bool view_asked = false;  ///< requested and not yet answered
    ResendTimer view = resend_timer();
    std::deque<MonotonicTime> unanswered;  ///< when a view was requested, the oldest first: answers keep their order
    ResendTimer definition = resend_timer();
  };
  static constexpr std::size_t kMaxEnded = 256;
  /// An answer to an older request has been lost by then.
  static constexpr Duration kAnswerLost = std::chrono::seconds(10);
  void take(const RunSummary& summary, Now now);
  void forget(const std::string& run, std::optional<RunState> state);
  [[nodiscard]] bool wants_definition(const WatchedRun& run) const { return run.view && !run.is_current(); }

  std::string node_;
  Runs runs_;
  std::map<std::string, Asking, std::less<>> asking_;
  std::set<std::string> changed_;
  std::set<std::string> timed_;
  std::deque<std::pair<std::string, RunState>> ended_;  ///< the oldest first
  bool has_table_ = false;
  bool is_watched_ = false;  ///< the scheduler has taken the watch, and is told again before that ends
  /// For as long as it is not taken, a run that needs a decision waits: so at most a second.
  ResendTimer watch_{std::chrono::milliseconds(200), std::chrono::seconds(1)};
  MonotonicTime renew_at_;
  std::optional<MonotonicTime> warned_at_;
};

}  // namespace trb::resilience
