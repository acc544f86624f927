// Who is told that a message was not delivered.
#pragma once

#include "proto/message.hpp"

namespace trb::router {

/// Commands, requests and a user's own information; nobody waits for an answer to an answer, to the middleware's own
/// information or to what may be lost.
bool deserves_nack(const HeaderView& header);

}  // namespace trb::router
