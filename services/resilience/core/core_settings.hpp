// The configuration of the resilience core.
#pragma once

#include <string>

#include "proto/bodies/link.hpp"
#include "services/resilience/core/proposals.hpp"

namespace trb::resilience {

struct CoreSettings {
  std::string node;
  Role role{};  ///< only a cloud node decides: the router of a robot's node signs no decision
  ResilienceSettings resilience;
  HallPlaces places;
};

}  // namespace trb::resilience
