#pragma once

#include <cstdint>
#include <string>

#include "services/virtual-robots/drone/aircraft.hpp"

namespace trb::virtual_robots::drone {

constexpr std::uint32_t kOptionTags = 28;  ///< of a drone 2: 0 (demo) to 27

/** An option of navdata, its header included. One whose content is not imitated has its right size and zeros. */
std::string navdata_option(std::uint32_t tag, const Aircraft& aircraft, double uptime_s);

}  // namespace trb::virtual_robots::drone
