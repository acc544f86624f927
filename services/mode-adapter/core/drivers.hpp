// The core controls its robot through drivers, which know the robot's words.
#pragma once

#include "common/drivers/driver.hpp"

namespace trb::adapter {

using namespace drivers;

}  // namespace trb::adapter
