// What each task of a played run waited for, and the chain of waits that made the run as long as it was.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace trb {

/// An attempt of a task.
struct PlayedTask {
  std::string id;
  std::string robot;
  double begin_s = 0;
  double end_s = 0;
  std::vector<std::string> after;  ///< the tasks that come before it
  bool has_failed = false;         ///< at `end_s`; else it was done
  bool is_open = false;            ///< it has no end: `end_s` is infinite
  bool is_dropped = false;         ///< another attempt of the task counts: it was done, or failed later
  std::size_t run = 0;             ///< of those that were played at once
  double since_s = 0;              ///< when that run was submitted
};

struct TaskWait {
  std::optional<std::size_t> holder{};  ///< the attempt whose end it waited for last, of its own task if that one had
                                        ///< failed; nullopt: it waited for none
  bool is_robot_busy = false;           ///< the holder is no predecessor: the robot had it to do
  bool is_critical = false;             ///< had it been shorter, a run would have been shorter
  double more_s = 0;  ///< from the holder's end, or without one from its run's submission, to its begin: it waited for
                      ///< what is no task's end, such as a result that was not here yet, a sensor's value, a decision
  double kept_s = 0;  ///< its own run had nothing before it for so long, but another run, the holder's, kept its robot
};

/// A hand-over and a decision of the cloud are no longer. Whether a wait beyond it hangs on the holder's end, as a slow
/// link's, or on none, as a cut one's, the times do not say: the critical path begins behind it.
constexpr double kLongestHandOver_s = 3;

/// For each attempt, in the order given. Tasks that are not among them held nothing up. Of several runs, each run's
/// last task ends a critical path, which may lead through tasks of the others.
std::vector<TaskWait> waits_of(const std::vector<PlayedTask>& tasks);

}  // namespace trb
