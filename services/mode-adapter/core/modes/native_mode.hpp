// Which mode speaks a robot's own language, by its transport.
#pragma once

#include <memory>

#include "services/mode-adapter/core/modes/mode.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

/// None for "lines": such a robot is spoken to in fields alone.
std::unique_ptr<RobotMode> make_native_mode(const Settings& settings);

}  // namespace trb::adapter
