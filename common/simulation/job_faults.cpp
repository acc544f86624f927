#include "common/simulation/job_faults.hpp"

#include <utility>

#include "common/simulation/job_times.hpp"

namespace trb::simulation {
namespace {

constexpr Range kFaultTimes{0, kMaxUntil};
constexpr Range kAhead{-1.5e9, 1.5e9};  // seconds: 47 years, all of them times of 64 bits in nanoseconds
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

void read_node(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  fault.node = reader.text("node", Need::required, kMaxId).value_or(kCloud);
  nodes.check(reader, "node", fault.node);
}

void read_robot(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  read_node(reader, nodes, fault);
  if (fault.node == kCloud && reader.value("node", Need::optional) != nullptr)
    reader.faults().add(reader.path("node"), "the cloud has no robot", "name a robot's node");
}

void read_nodes(ObjectReader& reader, const JobNodes& nodes, const char* key, std::vector<std::string>& out) {
  out = reader.texts(key, Need::required, kMaxRobots);
  for (const std::string& id : out) nodes.check(reader, key, id);
}

void read_side(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  read_nodes(reader, nodes, "nodes", fault.nodes);
  if (fault.nodes.empty()) reader.faults().add(reader.path("nodes"), "none is named", "name the nodes of one side");
  if (fault.nodes.size() > nodes.robots())
    reader.faults().add(reader.path("nodes"), "all nodes are on one side", "leave out those of the other side");
}

void read_ends(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  read_node(reader, nodes, fault);
  fault.other = reader.text("other", Need::optional, kMaxId).value_or("");
  fault.way = reader.one_of<Way>("way", Need::optional).value_or(Way::both);
  if (fault.other.empty()) return;
  nodes.check(reader, "other", fault.other);
  if (fault.other == fault.node)
    reader.faults().add(reader.path("other"), "is the node itself", "name another node, or leave it out");
}

void read_heal(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  read_time(reader, fault, Need::required);
  const bool of_side = reader.value("nodes", Need::optional) != nullptr;
  of_side ? read_side(reader, nodes, fault) : read_ends(reader, nodes, fault);
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

void read_rate(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  if (reader.value("node", Need::optional) != nullptr) read_robot(reader, nodes, fault);
  fault.rate.between_s = reader.number("between_s", Need::required, kBetween).value_or(fault.rate.between_s);
  fault.rate.repair_s = reader.number("repair_s", Need::optional, kFaultTimes);
}

void read_rest(ObjectReader& reader, const JobNodes& nodes, Fault& fault) {
  switch (fault.kind) {
    case FaultKind::fail:
    case FaultKind::repair:
      read_time(reader, fault, Need::required);
      return read_robot(reader, nodes, fault);
    case FaultKind::kill:
    case FaultKind::start:
      read_time(reader, fault, Need::required);
      return read_node(reader, nodes, fault);
    case FaultKind::cut:
      read_time(reader, fault, Need::optional);
      return read_ends(reader, nodes, fault);
    case FaultKind::partition:
      read_time(reader, fault, Need::optional);
      return read_side(reader, nodes, fault);
    case FaultKind::heal:
      return read_heal(reader, nodes, fault);
    case FaultKind::clock:
      read_time(reader, fault, Need::optional);
      read_node(reader, nodes, fault);
      return read_clock(reader, fault);
    case FaultKind::disk:
      read_time(reader, fault, Need::optional);
      read_node(reader, nodes, fault);
      fault.commit_s = reader.number("commit_s", Need::required, kCommit).value_or(0);
      return;
    case FaultKind::battery:
      read_time(reader, fault, Need::optional);
      read_robot(reader, nodes, fault);
      return read_battery(reader, fault);
    case FaultKind::rate:
      return read_rate(reader, nodes, fault);
  }
}

void read_fault(ObjectReader& reader, const JobNodes& nodes, std::vector<Fault>& out) {
  const auto kind = reader.one_of<FaultKind>("kind", Need::required);
  if (!kind) return;
  Fault fault;
  fault.kind = *kind;
  read_rest(reader, nodes, fault);
  reader.refuse_unknown_keys();
  out.push_back(std::move(fault));
}

}  // namespace

std::vector<Fault> read_faults(ObjectReader& reader, const JobNodes& nodes, std::size_t most) {
  std::vector<Fault> out;
  const Value::List* list = reader.list("faults", Need::optional, most);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    ObjectReader one((*list)[i], "faults[" + std::to_string(i) + "]", reader.faults());
    read_fault(one, nodes, out);
  }
  return out;
}

std::vector<std::string> read_relays(ObjectReader& reader, const JobNodes& nodes) {
  std::vector<std::string> out;
  if (reader.value("relays", Need::optional) != nullptr) read_nodes(reader, nodes, "relays", out);
  return out;
}

}  // namespace trb::simulation
