#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "services/virtual-robots/lines/body.hpp"
#include "services/virtual-robots/lines/message.hpp"
#include "services/virtual-robots/lines/session.hpp"
#include "services/virtual-robots/lines/vocabulary.hpp"

namespace trb::virtual_robots::lines {

/** The message that reports a body event; a start has none. */
std::optional<Message> message_of(const BodyEvent& event, const Vocabulary& vocabulary);

/** The line on stdout; an answer has none. */
std::optional<std::string> line_of(const BodyEvent& event);
std::string line_of(const SessionEvent& event);

/** `TYPE SUBTYPE TARGET DATA...`, the target `-` for the own node. */
std::optional<Message> parse_say(std::string_view words);

/** `CAPABILITY [SEVERITY [TEXT...]]`. */
std::optional<Message> parse_fault(std::string_view words, const Vocabulary& vocabulary);

/** The message that reports the end of the capability's fault. */
Message fault_over(const std::string& capability, const Vocabulary& vocabulary);

}  // namespace trb::virtual_robots::lines
