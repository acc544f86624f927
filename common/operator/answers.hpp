// What counts as an answer.
#pragma once

#include <string_view>

#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb::op {

/// Is this the answer to message `id`, which was for `target`? Good news counts only from whom it was asked. A Nack may
/// come from any router on the way, which is the own one's to check.
inline bool answers(const Message& message, std::uint64_t id, std::string_view target) {
  return message.reply_to == id && (message.source == target || message.subtype == Nack::kSubtype);
}

}  // namespace trb::op
