// Raises an alert for what a run's robots cannot do any more, and closes it when that is over.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "services/resilience/core/overdue.hpp"
#include "services/resilience/core/run_problems.hpp"
#include "services/resilience/core/verdicts.hpp"

namespace trb::resilience {

class Detection {
 public:
  Detection(Situation& situation, AlertLifecycle& alerts, Proposer& proposer, Verdicts& verdicts)
      : situation_(situation), alerts_(alerts), proposer_(proposer), verdicts_(verdicts) {}

  /// Looks at the runs that have changed, and at those that are due.
  void look(Now now, Outbox& out);

 private:
  void look_at(const WatchedRun& run, Now now, Outbox& out);
  void follow_end(const WatchedRun& run, Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_moment(const WatchedRun& run, Now now) const;
  [[nodiscard]] std::set<std::string> ruled_tasks(const WatchedRun& run);
  [[nodiscard]] std::vector<RunProblem> problems(const WatchedRun& run, Now now);
  [[nodiscard]] std::vector<RunProblem> overdue_problems(const WatchedRun& run, Now now);
  bool meet(const WatchedRun& run, const RunProblem& problem, Now now, Outbox& out);
  [[nodiscard]] Alert* find_alert(const WatchedRun& run, const RunProblem& problem);
  [[nodiscard]] bool is_over(const Alert& alert, const RunProblem& problem, Now now) const;
  void on_grown(Alert& alert, const WatchedRun& run, bool is_new, Now now, Outbox& out);
  void close_over(const WatchedRun& run, const std::vector<RunProblem>& found, Outbox& out);
  void skip_unbegun(const WatchedRun& run, Now now, Outbox& out);

  Situation& situation_;
  AlertLifecycle& alerts_;
  Proposer& proposer_;
  Verdicts& verdicts_;
  Overdue overdue_;
};

}  // namespace trb::resilience
