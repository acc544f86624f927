// The configuration of the adapter's core.
#pragma once

#include <functional>
#include <string>

#include "common/drivers/driver_settings.hpp"
#include "common/fleet/places.hpp"
#include "services/mode-adapter/core/drivers.hpp"
#include "services/mode-adapter/core/out_of_use_book.hpp"

namespace trb::adapter {

struct Settings : DriverSettings {
  std::string framework;
  Mode mode = Mode::none;
  Places places;
  bool fenced = false;             ///< as the last process left it
  std::vector<Kept> out_of_use{};  ///< as the last process left it
};

/// Keeps the fence over a restart. A port and not a journal record, because a robot must be stopped even if the disk is
/// full: the core stops the robot first, then calls this, then answers.
using PersistFence = std::function<Status(bool fenced)>;

/// Sends a line to the control port of a virtual robot; none: the robot is real, or not configured as virtual.
using InjectLine = std::function<Status(const std::string& line)>;

}  // namespace trb::adapter
