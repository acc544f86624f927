#include "services/simulator/job/fault_job.hpp"

#include <algorithm>

#include "services/simulator/job/plan_nodes.hpp"

namespace trb::simulator {
namespace {

using world::Fault;
using world::FaultKind;
using world::WorldPlan;

constexpr Range kFaultTimes{0, world::kMaxUntil};
constexpr Range kAhead{-1e10, 1e10};  // seconds
constexpr std::int64_t kMostDrift = 100'000;
constexpr Range kCommit{0, 60};
constexpr Range kPercent{0, 100};
constexpr Range kBetween{1, 1e7};

/// It says of itself when it begins, or is so from the world's start.
void read_time(ObjectReader& reader, Fault& fault, Need need) {
  const auto at = reader.number("at", need, kFaultTimes);
  fault.at_s = at.value_or(0);
  fault.from_start = need == Need::optional && !at;
}

void read_node(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  fault.node = reader.text("node", Need::required, kMaxId).value_or(kCloud);
  check_node(reader, plan, "node", fault.node);
}

void read_robot(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  read_node(reader, plan, fault);
  if (fault.node == kCloud && reader.value("node", Need::optional) != nullptr)
    reader.faults().add(reader.path("node"), "the cloud has no robot", "name a robot's node");
}

void read_nodes(ObjectReader& reader, const WorldPlan& plan, const char* key, std::vector<std::string>& out) {
  out = reader.texts(key, Need::required, world::kMaxRobots);
  for (const std::string& id : out) check_node(reader, plan, key, id);
}

void read_side(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  read_nodes(reader, plan, "nodes", fault.nodes);
  if (fault.nodes.empty()) reader.faults().add(reader.path("nodes"), "none is named", "name the nodes of one side");
  if (fault.nodes.size() > plan.robots)
    reader.faults().add(reader.path("nodes"), "all nodes are on one side", "leave out those of the other side");
}

void read_ends(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  read_node(reader, plan, fault);
  fault.other = reader.text("other", Need::optional, kMaxId).value_or("");
  fault.way = reader.one_of<world::Way>("way", Need::optional).value_or(world::Way::both);
  if (fault.other.empty()) return;
  check_node(reader, plan, "other", fault.other);
  if (fault.other == fault.node)
    reader.faults().add(reader.path("other"), "is the node itself", "name another node, or leave it out");
}

void read_heal(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  read_time(reader, fault, Need::required);
  const bool of_side = reader.value("nodes", Need::optional) != nullptr;
  of_side ? read_side(reader, plan, fault) : read_ends(reader, plan, fault);
}

void read_clock(ObjectReader& reader, Fault& fault) {
  const auto ahead = reader.number("ahead_s", Need::optional, kAhead);
  const auto drift = reader.integer("drift_ppm", Need::optional, -kMostDrift, kMostDrift);
  fault.clock = {ahead.value_or(0), drift.value_or(0), reader.boolean("is_1970", Need::optional).value_or(false)};
  if (ahead && fault.clock.is_1970)
    reader.faults().add(reader.path("ahead_s"), "a clock of 1970 is not ahead", "leave one of them out");
  if (!ahead && !drift && !fault.clock.is_1970)
    reader.faults().add(reader.path("ahead_s"), "is missing", "add ahead_s, drift_ppm or is_1970");
}

void read_battery(ObjectReader& reader, Fault& fault) {
  fault.battery.percent = reader.number("percent", Need::required, kPercent).value_or(100);
  fault.battery.per_second = reader.number("per_second", Need::required, kPercent).value_or(0);
}

void read_rate(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  if (reader.value("node", Need::optional) != nullptr) read_robot(reader, plan, fault);
  fault.rate.between_s = reader.number("between_s", Need::required, kBetween).value_or(fault.rate.between_s);
  fault.rate.repair_s = reader.number("repair_s", Need::optional, kFaultTimes);
}

void read_rest(ObjectReader& reader, const WorldPlan& plan, Fault& fault) {
  switch (fault.kind) {
    case FaultKind::fail:
    case FaultKind::repair:
      read_time(reader, fault, Need::required);
      return read_robot(reader, plan, fault);
    case FaultKind::kill:
    case FaultKind::start:
      read_time(reader, fault, Need::required);
      return read_node(reader, plan, fault);
    case FaultKind::cut:
      read_time(reader, fault, Need::optional);
      return read_ends(reader, plan, fault);
    case FaultKind::partition:
      read_time(reader, fault, Need::optional);
      return read_side(reader, plan, fault);
    case FaultKind::heal:
      return read_heal(reader, plan, fault);
    case FaultKind::clock:
      read_time(reader, fault, Need::optional);
      read_node(reader, plan, fault);
      return read_clock(reader, fault);
    case FaultKind::disk:
      read_time(reader, fault, Need::optional);
      read_node(reader, plan, fault);
      fault.commit_s = reader.number("commit_s", Need::required, kCommit).value_or(0);
      return;
    case FaultKind::battery:
      read_time(reader, fault, Need::optional);
      read_robot(reader, plan, fault);
      return read_battery(reader, fault);
    case FaultKind::rate:
      return read_rate(reader, plan, fault);
  }
}

void read_fault(ObjectReader& reader, WorldPlan& plan) {
  const auto kind = reader.one_of<FaultKind>("kind", Need::required);
  if (!kind) return;
  Fault fault;
  fault.kind = *kind;
  read_rest(reader, plan, fault);
  reader.refuse_unknown_keys();
  plan.faults.push_back(std::move(fault));
}

}  // namespace

void read_faults(ObjectReader& reader, WorldPlan& plan) {
  const Value::List* list = reader.list("faults", Need::optional, kMaxFaults);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    ObjectReader one((*list)[i], "faults[" + std::to_string(i) + "]", reader.faults());
    read_fault(one, plan);
  }
  if (reader.value("relays", Need::optional) != nullptr) read_nodes(reader, plan, "relays", plan.relays);
}

}  // namespace trb::simulator
