// What is left of a message's deadline when it is read.
#pragma once

#include "common/base/time.hpp"
#include "proto/message.hpp"

namespace trb {

/// Of a message that may have waited so long; at least 0 ms. Only what a person orders ages (the users' own commands
/// and requests, speeds, release, a repair, an injected fault, a run to be started): whoever gave it was told that
/// there was no answer in time, and the robot must not move then. What programs exchange is sent again until it is
/// confirmed, and a stop is right however late.
std::uint32_t remaining_after(Duration waited, MessageType type, std::string_view subtype, std::uint32_t remaining_ms);

}  // namespace trb
