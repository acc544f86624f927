// What a run's robots cannot do any more: from what the fleet and the run say now, and from nothing else.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/liveness.hpp"
#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

/// Alert::cause of a task that is due and names no robot: nothing has failed, somebody has to be chosen.
constexpr std::string_view kWantsRobot = "robot_wanted";

constexpr std::string_view kOverdue = "task_overdue";    ///< it should have ended, or begun
constexpr std::string_view kTwice = "double_execution";  ///< two robots have done it: the run is held
constexpr std::string_view kRunEnds = "run_ends";        ///< its time to live is nearly over
constexpr std::string_view kAsked = "asked";             ///< nothing has failed: a person wants it otherwise

struct RunProblem {
  std::string robot;
  std::string capability;  ///< that is gone; empty: the whole robot
  Severity severity{};
  std::string cause;  ///< as Alert::cause
  std::string text;
  std::vector<std::size_t> tasks;  ///< of the run, that cannot go on with this robot
  bool needs_confirmation = false;
  bool failed = false;  ///< a task of them has stopped: the robot's coming back alone does not end it
};

/// One for each robot that has any, in the order of its first task; before them one for each task that wants a robot,
/// with none in `robot`. Of tasks in `ruled`
/// it tells nothing: they are being decided on. The run is_known().
std::vector<RunProblem> problems_of(const WatchedRun& run, const Fleet& fleet, const Liveness& liveness,
                                    const std::set<std::string>& ruled, Now now);

/// Tasks that were done twice, in a run that is held for it: one for each robot. The run is_known().
std::vector<RunProblem> double_executions(const WatchedRun& run);

/// Why it may be decided only on a person's word; empty: it may be without. `retry`: the same robot does it again.
std::string why_confirmation(const WatchedRun& run, std::size_t task, const Fleet& fleet, bool retry);

/// The capability that the robot's skill of that task needs; empty: it is not known.
std::string capability_of(const WatchedRun& run, std::size_t task, const Fleet& fleet);

/// The fleet's WARNING and URGENT faults since then of what is not lost anyway, newest first: alerts without an id that
/// nobody decides on.
std::vector<Alert> lesser_faults(const Fleet& fleet, UtcTime since);

[[nodiscard]] bool wants_robot(const Alert& alert);
/// The failures of a robot in a run are one alert; what else there is to tell is one of its own for each cause.
[[nodiscard]] std::string_view family_of(std::string_view cause);
/// Somebody can do something about its tasks: move, try again or skip them.
[[nodiscard]] bool may_be_ruled(const Alert& alert);
/// The alert tells of a fault of its robot that takes that capability away.
[[nodiscard]] bool covers(const Alert& alert, std::string_view capability);
/// The task stays with its robot, whatever happens to it.
[[nodiscard]] bool is_pinned(const Alert& alert, const WatchedRun& run, std::string_view task);
/// It is the alert that this trouble made: of its family one for each robot of a run, one for each task that wants a
/// robot.
[[nodiscard]] bool is_about(const Alert& alert, const WatchedRun& run, const RunProblem& problem);

/// Of two causes the one that explains more: a fault explains the task that has failed of it.
int strength_of(std::string_view cause);

}  // namespace trb::resilience
