#include "services/simulator/world/standstill.hpp"

#include <algorithm>

#include "services/simulator/world/world.hpp"

namespace trb::world {
namespace {

/// Robots that fail by chance and are repaired do so for as long as the run is played.
bool goes_on_by_chance(const Fault& fault) {
  return fault.kind == FaultKind::rate && fault.rate.repair_s.has_value();
}

/// It may wait for a robot that another run keeps: only if none of them moves it stands still.
double still_for(const World& world) {
  if (std::ranges::any_of(world.plan().faults, goes_on_by_chance)) return 0;
  const double submitted_s = world.runs().front().outcome.submitted_s;
  const double since_s = std::max(world.moved_s(), submitted_s + world.plan().latest_s());
  const double still_s = world.seconds_passed() - since_s;
  return still_s < kStill_s ? 0 : still_s;
}

}  // namespace

Standstill standstill_of(const World& world, const WorldRun& run) {
  Standstill out;
  bool is_any_at_work = false;
  out.is_finished = run.outcome.state == RunState::finished;
  for (const auto& [id, alert] : world.nodes().at("cloud")->disk().alerts.alerts()) {
    if (alert.run == run.id && resilience::is_open(alert)) out.alerts.push_back(alert);
  }
  for (const auto& [id, node] : world.nodes()) {
    if (world.works_for(run, *node)) ++out.at_work;
    is_any_at_work = is_any_at_work || (node->robot() != nullptr && node->robot()->works());
    if (!world.is_open_at(*node, run.id)) continue;
    out.open_at.push_back(id);
    if (!node->is_up()) out.off.push_back(id);
  }
  if (!is_any_at_work && run.outcome.submitted_s > 0) out.still_s = still_for(world);
  return out;
}

}  // namespace trb::world
