// What a fleet of the paper does, as data: who works on which task, what is asked, who fails.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/result.hpp"

namespace trb::counting {

constexpr std::uint32_t kMaxPlannedRobots = 20'000;  ///< their identification is 2e8 messages: a second
constexpr std::uint32_t kMaxPlannedTasks = 1'000'000;
constexpr std::uint32_t kMaxDevices = 100'000;

/// Of one task.
struct PlannedTask {
  std::uint32_t robot = 0;            ///< who performs it in the end
  bool interpreted = false;           ///< it is told field by field
  std::uint32_t local_requests = 0;   ///< to a sensor of this robot
  std::uint32_t remote_requests = 0;  ///< to a sensor of another one
  bool taken_over = false;            ///< another robot has failed at it before
};

struct Plan {
  std::uint32_t robots = 1;
  std::vector<PlannedTask> tasks;    ///< one after the other
  std::vector<double> device_rates;  ///< updates a second of each device; device i is at robot i modulo `robots`
  double task_s = 3;                 ///< what each task takes
  double seconds = 0;                ///< until when devices send updates; 0: until the last task's end
};

/// Tasks given to the robots in turn, as the paper's simulator does; of the robots the first `interpreted` are told
/// field by field. Errors: bad_value, too_large, naming the number.
Result<Plan> cyclic_plan(std::uint32_t robots, std::uint32_t tasks, std::uint32_t interpreted);

}  // namespace trb::counting
