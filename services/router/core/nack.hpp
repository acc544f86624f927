// Who is told that a message was not delivered.
#pragma once

#include "common/base/result.hpp"
#include "proto/message.hpp"

namespace trb::router {

/// Commands, requests and a user's own information; nobody waits for an answer to an answer, to the middleware's own
/// information or to what may be lost.
bool deserves_nack(const HeaderView& header);
/// Nor, on another node, for what becomes of a message to every node.
bool deserves_nack_elsewhere(const HeaderView& header);
/// Its counter: a refusal of what should not have been sent, or a message that was dropped.
std::string undelivered_counter(Errc reason);

}  // namespace trb::router
