// What a run's robots cannot do any more: derived only from the present state of fleet and run.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/alert_causes.hpp"
#include "services/resilience/core/liveness.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

struct RunProblem {
  std::string robot;
  std::string capability;  ///< the one that is gone; empty: the whole robot
  Severity severity{};
  std::string cause;  ///< as Alert::cause
  std::string text;
  std::vector<std::size_t> tasks;  ///< of the run; they cannot go on with this robot
  bool needs_confirmation = false;
  bool failed = false;  ///< one of the tasks has stopped: the robot's return alone does not end it
};

/// One for each robot with problems, in the order of its first task; before them one, without a `robot`, for each task
/// that wants a robot. Tasks in `ruled` are left out: they are being decided on. The run is_known().
std::vector<RunProblem> problems_of(const WatchedRun& run, const Fleet& fleet, const Liveness& liveness,
                                    const std::set<std::string>& ruled, Now now);

/// Tasks that were done twice, in a run that is held because of it: one for each robot. The run is_known().
std::vector<RunProblem> double_executions(const WatchedRun& run);

/// Has the robot's node got new keys since it became a member of the run? Then nothing that it signs counts there, and
/// it begins nothing: for the run it is gone, whoever answers under its name.
bool has_new_keys(const WatchedRun& run, std::string_view robot, const Fleet& fleet);
inline constexpr const char* kNewKeys = "its node has got new keys since, and can do no more of the run";

/// Why a decision needs a person's statement; empty: it does not. `retry`: the same robot does it again.
std::string why_confirmation(const WatchedRun& run, std::size_t task, const Fleet& fleet, bool retry);

/// The capability that the robot's skill for that task needs; empty: not known.
std::string capability_of(const WatchedRun& run, std::size_t task, const Fleet& fleet);

/// The fleet's WARNING and URGENT faults since then, except of capabilities that are lost anyway, newest first: alerts
/// without an id, on which nobody decides.
std::vector<Alert> lesser_faults(const Fleet& fleet, UtcTime since);

[[nodiscard]] bool wants_robot(const Alert& alert);
/// A robot's failures in a run are one alert; each other cause is an alert of its own.
[[nodiscard]] std::string_view family_of(std::string_view cause);
/// Can its tasks be moved, tried again or skipped?
[[nodiscard]] bool may_be_ruled(const Alert& alert);
/// Is the alert about a fault of its robot that takes that capability away?
[[nodiscard]] bool covers(const Alert& alert, std::string_view capability);
/// Does the task stay with its robot in any case?
[[nodiscard]] bool is_pinned(const Alert& alert, const WatchedRun& run, std::string_view task);
/// Is it the alert of this problem? Per family there is one alert for each robot of a run, one for each task that wants
/// a robot.
[[nodiscard]] bool is_about(const Alert& alert, const WatchedRun& run, const RunProblem& problem);

/// Of two causes the stronger one explains more: a fault explains the task that failed because of it.
int strength_of(std::string_view cause);

}  // namespace trb::resilience
