// What reaches a core: a message whose body is already decoded.
#pragma once

#include <cstdint>
#include <string>

#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb {

/// A decoded message. The link has proven `source` (on the own bus it is the own node's id).
struct Inbound {
  MessageType type = MessageType::none;
  std::string source;
  std::string target;
  std::uint64_t id = 0;
  std::uint64_t reply_to = 0;
  std::uint16_t flags = 0;
  std::uint32_t remaining_ms = kDefaultRemainingMs;
  Body body;

  /// True if the sender waits for an answer.
  [[nodiscard]] bool wants_answer() const {
    return id != 0 && reply_to == 0 &&
           (type == MessageType::request || (type == MessageType::command && (flags & kFlagNoAnswer) == 0));
  }
};

}  // namespace trb
