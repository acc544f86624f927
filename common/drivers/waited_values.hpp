// What a description waits for: a robot's value that equals something. A driver that knows the value's type judges it.
#pragma once

#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

struct WaitedValue {
  std::string name;  ///< of the value, behind the request that may name it
  Value wanted;
  std::string by;  ///< the description's key: "faults.belt_slips.equals", "skills.run.end.fails_at"
};

std::vector<WaitedValue> waited_values(const NodeConfig& config);

/// As a person writes it: "22", "true", "\"three\"".
std::string text_of_wanted(const Value& wanted);

}  // namespace trb::drivers
