// What counts as an answer.
#pragma once

#include <string_view>

#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb::op {

/// Is this the answer to message `id`, which was for `target`? A positive answer counts only from the node that was
/// asked. A Nack may come from any router on the way, which the own router checks.
inline bool answers(const Message& message, std::uint64_t id, std::string_view target) {
  return message.reply_to == id && (message.source == target || message.subtype == Nack::kSubtype);
}

}  // namespace trb::op
