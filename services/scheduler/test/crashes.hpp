// A scheduler's process ends after any of its records.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/scheduler/test/fleet.hpp"

namespace trb::scheduler::test {

/// Lets the victim's process end as is due; to be called before anything is submitted.
using Doom = std::function<void(Fleet&)>;

/// Plays a story anew for each record of each victim, with the process ending there, before that step's messages are
/// sent and after it. `play` returns in how many steps the victim has journaled anything: fewer than `bound`.
void die_at_every_record(const std::vector<std::string>& victims, std::size_t bound,
                         const std::function<std::size_t(const std::string& victim, const Doom& doom)>& play);

}  // namespace trb::scheduler::test
