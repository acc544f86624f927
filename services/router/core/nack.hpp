// Who is notified that a message was not delivered.
#pragma once

#include "common/base/result.hpp"
#include "proto/message.hpp"

namespace trb::router {

/// Commands, requests and a user's own information get a Nack. Answers, the middleware's own information and what may
/// be lost do not: nobody waits for an answer to them.
bool deserves_nack(const HeaderView& header);
/// The same for another node's message; a message to every node gets none either.
bool deserves_nack_elsewhere(const HeaderView& header);
/// Its counter: a refusal of what should not have been sent, or a message that was dropped.
std::string undelivered_counter(Errc reason);

}  // namespace trb::router
