// Fills a command of commands.json with its data, as packets for the robot.
#pragma once

#include <optional>
#include <vector>

#include "common/base/result.hpp"
#include "common/drivers/arcos/journey.hpp"
#include "common/drivers/arcos/syntax.hpp"

namespace trb::drivers {

struct ArcosOrder {
  Bytes packets;
  bool moves = false;
  bool stops = false;
  bool resets_origin = false;   ///< SETO
  std::optional<bool> enables;  ///< the motors: on or off
  std::optional<ArcosGoal> goal;
};

/// Numbers are rounded to whole ones. Errors: bad_value (naming the step), too_large (a text).
Result<ArcosOrder> fill_arcos(const std::vector<ArcosStep>& steps, BytesView data);

}  // namespace trb::drivers
