// The number of messages of a run after the paper (section 5.1): Equations 1 to 12, a function each.
#pragma once

#include <cstdint>

#include "common/base/result.hpp"
#include "common/model/checks.hpp"

namespace trb::model {

/// The paper's variables, by its names. Counts, but for `delta_t` and `sum_x`.
struct PaperParameters {
  std::uint64_t n = 1;      ///< robots
  std::uint64_t N_d = 0;    ///< tasks told in the modes direct or ros
  std::uint64_t N_i = 0;    ///< tasks told in the mode interpreter
  std::uint64_t k = 0;      ///< blocks: at least two tasks of one actor, one after the other
  std::uint64_t sum_m = 0;  ///< tasks in all of these blocks
  std::uint64_t s = 0;      ///< devices (sensors)
  double sum_x = 0;         ///< messages that all devices together send in a second, 1/s
  double delta_t = 0;       ///< duration, s
  std::uint64_t R_l = 0;    ///< requests to a sensor of the robot that asks
  std::uint64_t R_e = 0;    ///< requests to a sensor of another robot
  std::uint64_t N_f = 0;    ///< robots that fail
  bool operator==(const PaperParameters&) const = default;
};

/// What follows for a fleet: every term is then a whole number below 2^53, but for updates at a fractional rate.
/// Errors: bad_value or too_large, naming the variable and `trb model`'s option.
Status check(const PaperParameters& parameters);

/// The equations expect parameters that have passed check(). Unit: messages.

/// Equation 1: 3n + 1. Each robot's start, its answer, "waiting"; the scenario to the first actor.
double boot(const PaperParameters& p);
/// Equation 2: n(n+1)/2. Each robot's broadcast, and the acknowledgement of each that was there before.
double identification(const PaperParameters& p);
/// Equation 3: 2s + delta_t sum x_i. Each device to the cloud and to the robots, then its updates.
double devices(const PaperParameters& p);
/// Equation 4: (1) + (2) + (3).
double start(const PaperParameters& p);
/// Equation 5: N_d + N_i tasks.
std::uint64_t tasks(const PaperParameters& p);
/// Equation 7: 4 N_d + 8 N_i. Ready, the task (five fields in the interpreter mode), done, done to the cloud.
double task(const PaperParameters& p);
/// Equation 8: N_task - sum m_j + k - 1. How often the actor changes.
double forward(const PaperParameters& p);
/// Equations 6 and 9: (7) + (8).
double scenario(const PaperParameters& p);
/// Equation 10: 2 R_l + 4 R_e. Request and answer, each passed on once more to a sensor of another robot.
double sensor(const PaperParameters& p);
/// Equation 11: 2 N_f. The fault to the cloud, the changed scenario back.
double failures(const PaperParameters& p);
/// Equation 12: (4) + (9) + (10) + (11).
double total(const PaperParameters& p);

/// Section 6.2's bounds for its demonstration: five robots, nine tasks, one sensor at 1 Hz, 180 s.
/// All tasks by one actor, told directly, one local request: Equation 12 gives 251, as the paper prints.
PaperParameters paper_best_case();
/// Each task by another actor, told field by field, a remote request, one fault: Equation 12 gives 299; the paper
/// prints 297.
PaperParameters paper_worst_case();

}  // namespace trb::model
