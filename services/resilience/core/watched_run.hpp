// A run of the own scheduler, as far as the resilience needs it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/run.hpp"

namespace trb::resilience {

/// As the schedulers have them: attempts of a task (a skip may be one more), and decisions of a run.
constexpr std::uint32_t kMaxAttempts = 64;
constexpr std::uint32_t kMaxDecisions = 64;

struct WatchedRun {
  RunSummary summary;
  std::optional<RunView> view;
  std::optional<RunStart> start;         ///< nothing before the scheduler has given the definition
  std::vector<Decision> decisions;       ///< from epoch 2 on, as the definition had them
  std::optional<MonotonicTime> ends_at;  ///< its time to live; nothing: the scheduler does not tell it
  Bytes last_decision;                   ///< payload of the last of them; empty: there is none

  /// It has all that is needed to speak about it. A decision needs is_current() besides.
  [[nodiscard]] bool is_known() const { return view && start; }
  /// The definition has every decision that the view has.
  [[nodiscard]] bool is_current() const { return is_known() && decisions.size() + 1 == view->epoch; }
  /// Who decides: the first cloud node among the start's members; empty: nobody.
  [[nodiscard]] std::string decider() const;
  [[nodiscard]] bool is_member(std::string_view node) const;
  [[nodiscard]] std::optional<std::size_t> find_task(std::string_view id) const;
  /// The number of the first attempt since it was ruled on last. The run has its view.
  [[nodiscard]] std::uint32_t first_attempt(std::size_t task) const;
  /// The number of the task's last attempt that anybody knows of, at least 1. The run has its view.
  [[nodiscard]] std::uint32_t last_attempt(std::size_t task) const;
  /// The same, but with those that its robot may have made unheard.
  [[nodiscard]] std::uint32_t last_possible_attempt(std::size_t task) const;
  /// How often the policy has moved the task: a first robot for one that named none is no move. The run is_known().
  [[nodiscard]] std::uint32_t policy_moves(std::size_t task) const;
  /// Its last attempt has ended without finishing: FAILED, retriable, interrupted, or given back.
  [[nodiscard]] bool has_stopped(std::size_t task) const;
};

/// FINISHED, ABORTED, ABORTING or EXPIRED: nobody is looked for any more.
[[nodiscard]] bool is_over(RunState state);
[[nodiscard]] bool is_final(const TaskView& task);

}  // namespace trb::resilience
