// What the kernel tells of the disk that a folder is on, and of the clock.
#pragma once

#include <optional>
#include <string>

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::op {

/// Empty if the folder is not there.
std::optional<DiskState> disk_state(const std::string& folder);

/// Whether something keeps the clock set (adjtimex(2): STA_UNSYNC is not there); empty where the kernel does not tell.
std::optional<bool> is_clock_set();

}  // namespace trb::op
