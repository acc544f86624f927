// What a client says on the live stream.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "common/base/bytes.hpp"
#include "services/cloud-gateway/core/live/client_feed.hpp"
#include "services/cloud-gateway/core/live/drives.hpp"
#include "services/cloud-gateway/core/live/topic.hpp"

namespace trb::gateway {

struct Subscribe {
  Topic topic;
  std::optional<Resume> resume{};
};
struct Unsubscribe {
  Topic topic;
};
/// Somebody wants to drive a robot that another one drives.
struct AskFor {
  std::string robot;
};
struct LetGo {
  std::string robot;
};
using LiveWord = std::variant<Subscribe, Unsubscribe, DriveWord, AskFor, LetGo>;

/// {"subscribe": TOPIC, "instance"?, "from"?}, {"unsubscribe": TOPIC}, or a word of drive_words.hpp. Errors: those of
/// parse_json(), parse_topic() and read_drive_word(); bad_value.
Result<LiveWord> read_live_word(BytesView text);

}  // namespace trb::gateway
