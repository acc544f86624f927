// The bridge's core: BridgeCommands in, words to the worker out; what the worker gets, as BridgeEvents. It owns the
// types, the codec and the watch over the worker.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/core.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/value.hpp"
#include "services/ros-bridge/core/message_type.hpp"
#include "services/ros-bridge/core/worker_syntax.hpp"

namespace trb::ros {

struct BridgeSettings {
  std::string id;      ///< the own node's
  std::string master;  ///< the ROS master's URI, for people
  std::uint64_t instance = 0;
};

/// What the core wants done at its worker: bytes to write, and whether to kill it.
struct WorkerOutput {
  Bytes bytes;
  bool kill = false;

  [[nodiscard]] bool empty() const { return bytes.empty() && !kill; }
};

class BridgeCore : public Core {
 public:
  /// `read` gives a type's definition.
  BridgeCore(BridgeSettings settings, TypeStore::Read read);

  void on_welcome(const NodeIdentity& node, Now now, Outbox& out) override;
  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  void on_worker_started(Now now, Outbox& out);
  void on_worker_bytes(BytesView bytes, Now now, Outbox& out);
  void on_worker_ended(const std::string& reason, Now now, Outbox& out);
  /// What the worker gets of the steps since the last call: to be carried out once their messages are sent.
  [[nodiscard]] WorkerOutput take_worker_output() { return std::exchange(output_, {}); }

 private:
  struct Publication {
    std::uint64_t token = 0;  ///< the mode-adapter's
    std::string topic;
    Value data;
    MonotonicTime deadline;
  };
  struct Listener {
    std::uint64_t token = 0;
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
  struct KnownType {
    std::string name;
    MonotonicTime heard;
  };

  void on_command(const BridgeCommand& command, Now now, Outbox& out);
  void begin_publish(const BridgeCommand& command, Now now, Outbox& out);
  void publish(Publication publication, const std::string& type, Now now, Outbox& out);
  void listen(const BridgeCommand& command, Now now, Outbox& out);
  /// Ends all that has that token: a watch, an ask, a publication that has not left yet.
  void forget(std::uint64_t token, Now now);
  /// Of an adapter that is gone: nobody waits for it, and nobody could still stop it.
  void forget_adapter();
  /// Neither is it published later.
  void drop_published();
  void on_worker_message(WorkerMessage& message, Now now, Outbox& out);
  void on_alive(bool up, const std::string& detail, Now now, Outbox& out);
  void on_type(const std::string& topic, const std::string& type, Now now, Outbox& out);
  void on_message(WorkerMessage& message, Now now, Outbox& out);
  /// Others have had it already: told again it would look as if the robot had just said it.
  void on_kept(const WorkerMessage& message, Now now, Outbox& out);
  void on_topic_failed(const std::string& topic, const Error& error, Now now, Outbox& out);
  /// Tells it to those listeners whose time has come. True: it is still owed to others.
  bool send_message(Topic& topic, const WorkerMessage& message, Now now, Outbox& out);
  void send_owed(Now now, Outbox& out);
  Result<Value> read_message(const WorkerMessage& message);
  Result<RosTypePtr> type_of(const std::string& name);
  void end_publish(std::uint64_t token, const std::optional<Error>& error, Outbox& out);
  void expire(Now now, Outbox& out);
  void expire_listeners(Now now, Outbox& out);
  void event(std::uint64_t token, BridgeResult result, std::string data, const std::optional<Error>& error,
             Outbox& out) const;
  void fail_event(std::uint64_t token, const Error& error, Outbox& out) const {
    event(token, BridgeResult::failed, {}, error, out);
  }
  void send_to_worker(Word word, std::vector<Bytes> parts) { output_.bytes += to_bytes({word, std::move(parts)}); }
  void forget_all();
  void set_state(bool up, const std::string& detail, Now now, Outbox& out);
  void send_state(Now now, Outbox& out);

  BridgeSettings settings_;
  TypeStore store_;
  std::map<std::string, RosTypePtr> heard_types_;  ///< by sum: from headers of connections
  WorkerReader reader_;
  WorkerOutput output_;
  bool worker_ = false;
  bool up_ = false;
  bool welcomed_ = false;
  std::string detail_;
  std::uint64_t connection_;
  std::uint64_t adapter_ = 0;
  MonotonicTime alive_;
  MonotonicTime next_state_;
  std::uint64_t last_key_ = 0;
  std::map<std::string, KnownType> topic_types_;
  std::map<std::string, std::vector<Publication>> looked_up_;  ///< by topic: wait for its type
  std::map<std::uint64_t, Publication> published_;             ///< by the worker's token
  std::map<std::string, Topic> topics_;
};

}  // namespace trb::ros
