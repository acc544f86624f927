// A run of the own scheduler, as far as this service needs it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/run_view.hpp"

namespace trb::resilience {

/// The same bounds as in the schedulers: attempts of a task (a skip may be one more), and decisions of a run.
constexpr std::uint32_t kMaxAttempts = 64;
constexpr std::uint32_t kMaxDecisions = 64;

struct WatchedRun {
  RunSummary summary;
  std::optional<RunView> view;
  MonotonicTime view_as_of;       ///< when the view was requested: it shows the run of then, or later
  std::optional<RunStart> start;  ///< nothing before the scheduler has sent the definition
  std::map<std::string, Certificate, std::less<>> certificates;  ///< its members', as the definition has them
  std::vector<Decision> decisions;                               ///< from epoch 2 on, as in the definition
  std::optional<MonotonicTime> ends_at;  ///< the end of its life; nothing: the scheduler does not report it
  Bytes last_decision;                   ///< payload of the last of them; empty: there is none

  /// Is everything known that an alert needs? A decision also needs is_current().
  [[nodiscard]] bool is_known() const { return view && start; }
  /// Does the definition have every decision of the view?
  [[nodiscard]] bool is_current() const { return is_known() && decisions.size() + 1 == view->epoch; }
  /// Its scheduler, which may have lost it, asks the members what was decided and done: what it shows may be old, and
  /// it takes no decision. Nothing is raised, decided or closed until then.
  [[nodiscard]] bool recovers() const;
  /// The node that decides: the first cloud node among the start's members; empty: none.
  [[nodiscard]] std::string decider() const;
  [[nodiscard]] bool is_member(std::string_view node) const;
  /// Takes the members' certificates from start and decisions.
  void learn_certificates();
  [[nodiscard]] std::optional<std::size_t> find_task(std::string_view id) const;
  /// The number of the first attempt since the last ruling on the task. The run has its view.
  [[nodiscard]] std::uint32_t first_attempt(std::size_t task) const;
  /// The number of the task's last known attempt, at least 1. The run has its view.
  [[nodiscard]] std::uint32_t last_attempt(std::size_t task) const;
  /// The same, including attempts that its robot may have made without a report.
  [[nodiscard]] std::uint32_t last_possible_attempt(std::size_t task) const;
  /// How often the policy has moved the task; choosing a first robot for a task that named none is no move. The run
  /// is_known().
  [[nodiscard]] std::uint32_t policy_moves(std::size_t task) const;
  /// Has its last attempt ended without finishing: FAILED, retriable, interrupted, or given back?
  [[nodiscard]] bool has_stopped(std::size_t task) const;
};

/// FINISHED, ABORTED, ABORTING or EXPIRED: no robot is searched any more.
[[nodiscard]] bool is_over(RunState state);
[[nodiscard]] bool is_final(const TaskView& task);

}  // namespace trb::resilience
