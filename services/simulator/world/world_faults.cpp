// What goes wrong in a world, as its plan says, and what of its plan had no time any more.
#include <algorithm>

#include "services/simulator/world/world.hpp"

namespace trb::world {

void World::prepare_faults() {
  for (const Fault& fault : plan_.faults) {
    if (fault.from_start) happen(fault);
  }
}

void World::plan_faults() {
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    const Fault& fault = plan_.faults[i];
    if (fault.kind == FaultKind::rate) {
      draw_faults(fault);
    } else if (!fault.from_start) {
      events_.after(seconds(fault.at_s), [this, i] {
        reached_.insert(i);
        happen(plan_.faults[i]);
      });
    }
  }
}

std::vector<LateFault> World::not_reached() const {
  std::vector<LateFault> out;
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    const Fault& fault = plan_.faults[i];
    const bool has_time = fault.kind != FaultKind::rate && !fault.from_start;
    if (has_time && !reached_.contains(i)) out.push_back({i, fault.at_s});
  }
  return out;
}

std::vector<LateSensor> World::steps_not_reached() const {
  constexpr double kRounded_s = 1e-6;  // the world's times are whole nanoseconds
  std::vector<LateSensor> out;
  for (std::size_t i = 0; i < plan_.sensors.size(); ++i) {
    const auto late = plan_.sensors[i].course.after(run_seconds() + kRounded_s);
    if (late) out.push_back({i, *late});
  }
  return out;
}

void World::draw_faults(const Fault& rate) {
  for (const PlannedRobot& robot : plan_.fleet) {
    if (rate.node.empty() || rate.node == robot.id) fail_by_chance(rate.rate, robot.id);
  }
}

/// The next failure is drawn when the one before is over: a list of a week's would have millions.
void World::fail_by_chance(const FaultRate& rate, const std::string& robot) {
  const auto after_s = time_to_failure(rate.between_s, to_seconds(limit_ - events_.now()), chance_of_faults_);
  if (!after_s) return;
  events_.after(seconds(*after_s), [this, &rate, &robot] {
    happen({.kind = FaultKind::fail, .node = robot});
    if (rate.repair_s)
      events_.after(seconds(*rate.repair_s), [this, &rate, &robot] { repair_until_next(rate, robot); });
  });
}

void World::repair_until_next(const FaultRate& rate, const std::string& robot) {
  happen({.kind = FaultKind::repair, .node = robot});
  fail_by_chance(rate, robot);
}

void World::crash(const std::string& node) {
  happen({.kind = FaultKind::kill, .node = node});
  events_.after(std::chrono::seconds(1), [this, node] { happen({.kind = FaultKind::start, .node = node}); });
}

void World::happen(const Fault& fault) {
  if (on_fault) on_fault(fault);
  if (fault.node.empty()) return happen_between(fault);
  Node& node = *nodes_.at(fault.node);
  switch (fault.kind) {
    case FaultKind::fail:
      return node.robot()->fail();
    case FaultKind::repair:
      return node.robot()->repair();
    case FaultKind::battery:
      return node.robot()->set_battery(fault.battery);
    case FaultKind::kill:
      for (WorldRun& run : runs_) {
        run.witness.on_kill(fault.node, events_.seconds_passed(), to_seconds(node.disk().commit));
      }
      return node.kill();
    case FaultKind::start:
      return node.is_up() ? void() : node.start();
    case FaultKind::clock:
      return node.set_clock(fault.clock);
    case FaultKind::disk:
      return node.set_commit(seconds(fault.commit_s));
    case FaultKind::cut:
    case FaultKind::heal:
    case FaultKind::partition:
    case FaultKind::rate:
      return happen_between(fault);
  }
}

/// A node and another one or all others, or those of a partition and all others.
void World::happen_between(const Fault& fault) {
  const auto is_here = [&](const std::string& id) {
    return id == fault.node || std::ranges::find(fault.nodes, id) != fault.nodes.end();
  };
  for (const auto& [here, one] : nodes_) {
    for (const auto& [there, other] : nodes_) {
      if (!is_here(here) || is_here(there) || (!fault.other.empty() && fault.other != there)) continue;
      change_way(fault, here, there);
    }
  }
}

void World::change_way(const Fault& fault, const std::string& one, const std::string& other) {
  const bool heals = fault.kind == FaultKind::heal;
  if (fault.way != Way::back) heals ? network_.heal(one, other) : network_.cut(one, other);
  if (fault.way != Way::there) heals ? network_.heal(other, one) : network_.cut(other, one);
}

}  // namespace trb::world
