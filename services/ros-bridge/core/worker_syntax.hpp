// What the bridge and its worker say to each other through two pipes. The worker is the process that holds the ROS
// handles; whatever blocks there blocks nobody else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::ros {

enum class Word : std::uint8_t {
  // to the worker
  look_up = 1,  ///< topic
  publish,      ///< token, topic, type, md5, definition, deadline (CLOCK_MONOTONIC, ns), wire
  subscribe,    ///< topic; of one that is subscribed to already: what ROS keeps of it
  unsubscribe,  ///< topic
  // of the worker
  alive,      ///< "up" or "absent", detail; every half second
  type,       ///< topic, type ("" if the master knows none)
  published,  ///< token
  failed,     ///< token, Errc's name, what, hint
  message,    ///< topic, type, md5, definition, wire
  // to the worker
  drop,  ///< token: what was not published yet is not published any more, and not answered
  // of the worker
  kept,          ///< as message: a latched topic's last one, once more, for who has begun to listen since
  topic_failed,  ///< topic, Errc's name, what, hint: nothing can come of it
  unread,        ///< topic, Errc's name, what, hint: instead of one message, which the bridge could not take
};

struct WorkerMessage {
  Word word{};
  std::vector<Bytes> parts;
};

/// Largest message between them, in bytes.
constexpr std::size_t kMaxWorkerMessage = 4U << 20U;

/// How many publications may wait at the worker. Once somebody subscribes they are all published at once.
constexpr std::size_t kMaxPublications = 256;

Bytes to_bytes(const WorkerMessage& message);

/// Of failed, topic_failed and unread: what went wrong.
Error error_of(const WorkerMessage& message);

/// Puts messages together from what a pipe gives.
class WorkerReader {
 public:
  /// Errors: malformed, too_large; the pipe is of no use any more then.
  Status add(BytesView bytes, std::vector<WorkerMessage>& out);

 private:
  Bytes rest_;
};

/// How many parts a word has; 0 for none such.
std::size_t parts_of(Word word);

}  // namespace trb::ros
