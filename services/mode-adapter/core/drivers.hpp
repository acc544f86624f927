// The core speaks to its robot by drivers: their words are its own.
#pragma once

#include "common/drivers/driver.hpp"

namespace trb::adapter {

using namespace drivers;

}  // namespace trb::adapter
