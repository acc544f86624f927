// Who listens to which topic: an ask gets the next message, a watch each one, ten a second at most, and of those that
// come faster the newest. It owns the listeners, what they are still owed, and the types that came with messages.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/value.hpp"
#include "services/ros-bridge/core/bridge_out.hpp"
#include "services/ros-bridge/core/message_type.hpp"
#include "services/ros-bridge/core/worker_syntax.hpp"

namespace trb::ros {

class Listeners {
 public:
  static constexpr std::size_t kMaxTopics = 256;
  static constexpr std::size_t kMaxOfTopic = 256;
  /// A topic to which nobody has listened for so long is unsubscribed from.
  static constexpr Duration kIdle = std::chrono::seconds(30);

  /// Takes an ask, which fails at the deadline, or a watch, which has none. It fails at once with queue_full if there
  /// are too many topics, or too many listeners of this one.
  void listen(const BridgeCommand& command, MonotonicTime deadline, Now now, const BridgeOut& out);
  /// Ends the asks and watches with that token.
  void forget(std::uint64_t token, Now now);
  /// Of an adapter or a master that is gone: nobody listens any more. The worker's subscriptions stay for a while.
  void forget_all();
  /// Of a worker that is gone: there is no subscription either.
  void clear() { topics_.clear(); }

  /// A topic's message (Word::message), or what stands for one (Word::unread); it is moved from if it is still owed to
  /// somebody. One that cannot be used fails the asks; to the watches, which go on, the value is unknown.
  void on_message(WorkerMessage& message, Now now, const BridgeOut& out);
  /// Word::kept. Others have had it already: told again it would look as if the robot had just said it.
  void on_kept(const WorkerMessage& message, Now now, const BridgeOut& out);
  /// All who listen to that topic fail, the watches, too.
  void on_failed(const std::string& topic, const Error& error, Now now, const BridgeOut& out);
  /// Tells what is owed by now, ends the asks whose time is over, unsubscribes from topics that are idle.
  void tick(Now now, const BridgeOut& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

  /// A type as it came with the newest message that has it; nullptr: none of that name has come. It outlives the
  /// subscriptions: what is published first when the robot is back, a stop, may need it.
  [[nodiscard]] RosTypePtr heard_type(const std::string& name) const;

 private:
  struct Listener {
    std::uint64_t token = 0;  ///< the mode-adapter's
    std::vector<std::string> paths;
    bool watch = false;
    MonotonicTime deadline;  ///< of an ask
    MonotonicTime next;      ///< a watch tells nothing before
    bool owed = false;       ///< a watch: the topic's newest message was not told, for it came too soon
    bool told = false;       ///< it has had a message
  };
  struct Topic {
    std::vector<Listener> listeners;
    std::optional<WorkerMessage> newest{};  ///< kept as long as it is owed to one of them
    std::optional<MonotonicTime> idle_since;
  };

  /// Tells it to those listeners whose time has come. True: it is still owed to others.
  bool send_message(Topic& topic, const WorkerMessage& message, Now now, const BridgeOut& out);
  void send_owed(Now now, const BridgeOut& out);
  void expire(Now now, const BridgeOut& out);
  Result<RosTypePtr> type_of(const WorkerMessage& message);
  /// What a listener wants of a topic's message, as JSON.
  Result<std::string> json_of(const WorkerMessage& message, const std::vector<std::string>& paths);

  std::map<std::string, Topic> topics_;
  std::map<std::string, RosTypePtr> heard_types_;  ///< by name: from headers of connections
};

}  // namespace trb::ros
