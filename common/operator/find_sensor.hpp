// Which sensor of the fleet is meant: looked up in the route table.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "proto/bodies/link.hpp"

namespace trb::op {

struct FoundSensor {
  std::string node;
  std::string node_state;  ///< "self", "ONLINE" …
  SensorInfo info;

  [[nodiscard]] bool reached() const { return node_state == "self" || node_state == "ONLINE"; }
};

/// Every plugged sensor of the fleet, node by node.
std::vector<FoundSensor> all_sensors(const RouteTable& table);

/// What a person has given: a name or kind, a node, an identity; all but the first may be empty.
struct SensorWish {
  std::string name;
  std::string node;
  std::string identity;
};

/// The sensor that is meant; of several preferably one that sends values, then the own node's. If a node is named that
/// has no such sensor in its profile, it is asked nevertheless: a program may be about to provide it. Errors:
/// unknown_target (with the existing names), bad_value (a kind of which a node has several; an
/// identity that two nodes claim: both read it, or neither does).
Result<FoundSensor> find_sensor(const RouteTable& table, const SensorWish& wish);

}  // namespace trb::op
