#include "services/simulator/world/standstill.hpp"

#include <algorithm>

#include "services/simulator/world/world.hpp"

namespace trb::world {
namespace {

/// Robots that fail by chance and are repaired do so for as long as the run is played.
bool goes_on_by_chance(const Fault& fault) {
  return fault.kind == FaultKind::rate && fault.rate.repair_s.has_value();
}

double still_for(const World& world, double submitted_s) {
  if (std::ranges::any_of(world.plan().faults, goes_on_by_chance)) return 0;
  const double since_s = std::max(world.witness().moved_s(), submitted_s + world.plan().latest_s());
  const double still_s = world.seconds_passed() - since_s;
  return still_s < kStill_s ? 0 : still_s;
}

}  // namespace

Standstill standstill_of(const World& world, double submitted_s) {
  Standstill out;
  for (const auto& [id, alert] : world.nodes().at("cloud")->disk().alerts.alerts()) {
    if (alert.run == world.run() && resilience::is_open(alert)) out.alerts.push_back(alert);
  }
  for (const auto& [id, node] : world.nodes()) {
    if (node->robot() != nullptr && node->robot()->works()) ++out.at_work;
    if (!world.is_open_at(*node)) continue;
    out.open_at.push_back(id);
    if (!node->is_up()) out.off.push_back(id);
  }
  if (out.at_work == 0 && submitted_s > 0) out.still_s = still_for(world, submitted_s);
  return out;
}

}  // namespace trb::world
