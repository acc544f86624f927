// A robot's text about a fault, where its program can report more than its controller.
#pragma once

#include <string>
#include <vector>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// "CAPABILITY SEVERITY TEXT"; any other text is a critical fault of the whole robot.
FaultSaid read_fault_text(std::string_view text, const std::vector<std::string>& capabilities, std::string cause);

}  // namespace trb::drivers
