#include "services/simulator/counting/plan.hpp"

#include <string>

namespace trb::counting {
namespace {

Error too_many(const std::string& name, std::uint32_t count, std::uint32_t most) {
  return fail(Errc::too_large, name + ": " + std::to_string(count) + " is too many",
              "use at most " + std::to_string(most));
}

}  // namespace

Result<Plan> cyclic_plan(std::uint32_t robots, std::uint32_t tasks, std::uint32_t interpreted) {
  if (robots == 0) return fail(Errc::bad_value, "robots: there is none", "use at least 1");
  if (tasks == 0) return fail(Errc::bad_value, "tasks: there is none", "use at least 1");
  if (robots > kMaxPlannedRobots) return too_many("robots", robots, kMaxPlannedRobots);
  if (tasks > kMaxPlannedTasks) return too_many("tasks", tasks, kMaxPlannedTasks);
  if (interpreted > robots) return too_many("interpreted", interpreted, robots);
  Plan plan{.robots = robots, .tasks = std::vector<PlannedTask>(tasks), .device_rates = {}};
  for (std::uint32_t i = 0; i < tasks; ++i) {
    plan.tasks[i].robot = i % robots;
    plan.tasks[i].interpreted = i % robots < interpreted;
  }
  return plan;
}

}  // namespace trb::counting
