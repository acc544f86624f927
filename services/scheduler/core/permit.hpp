// What a run allows an attempt of this node's robot.
#pragma once

#include <cstdint>

namespace trb::scheduler {

/// `hold` (a person holds the run): what runs goes on, what has not begun waits. `give_back` (the decider asks for it),
/// `too_late` (start_within_s has passed), `no_more` (expired): the same, but what has not begun ends so. `stop` (the
/// decider asks for it, and that it stops): the same as give_back, and what runs is stopped, as something that may be
/// tried again. `cancel` (aborted, or the task is another robot's now): stop it.
enum class Permit : std::uint8_t { go = 0, hold, give_back, too_late, no_more, stop, cancel };

}  // namespace trb::scheduler
