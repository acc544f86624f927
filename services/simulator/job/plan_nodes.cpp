#include "services/simulator/job/plan_nodes.hpp"

#include <algorithm>

namespace trb::simulator {

bool is_node(const world::WorldPlan& plan, const std::string& id) {
  if (id == kCloud) return true;
  if (!plan.fleet.empty()) {
    return std::ranges::any_of(plan.fleet, [&](const world::PlannedRobot& robot) { return robot.id == id; });
  }
  for (std::uint32_t i = 0; i < plan.robots; ++i) {
    if (id == "r" + std::to_string(i)) return true;
  }
  return false;
}

void check_node(const ObjectReader& reader, const world::WorldPlan& plan, const char* key, const std::string& id) {
  if (is_node(plan, id)) return;
  reader.faults().add(reader.path(key), "'" + id + "' is no node",
                      plan.fleet.empty() ? "use cloud, or r0 to r" + std::to_string(plan.robots - 1)
                                         : "use cloud, or the id of a robot of the fleet");
}

}  // namespace trb::simulator
