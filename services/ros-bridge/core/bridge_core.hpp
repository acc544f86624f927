// The bridge's core: BridgeCommands in, words to the worker out; what the worker gets, as BridgeEvents. It owns the
// publications, the types of topics and the watch over the worker; Listeners has who listens.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/actor/core.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/value.hpp"
#include "services/ros-bridge/core/bridge_out.hpp"
#include "services/ros-bridge/core/listeners.hpp"
#include "services/ros-bridge/core/message_type.hpp"
#include "services/ros-bridge/core/worker_syntax.hpp"

namespace trb::ros {

struct BridgeSettings {
  std::string id;      ///< the own node's
  std::string master;  ///< the ROS master's URI, for people
  std::uint64_t instance = 0;
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
  struct KnownType {
    std::string name;
    MonotonicTime heard;
  };

  void on_command(const BridgeCommand& command, Now now, Outbox& outbox);
  void begin_publish(const BridgeCommand& command, Now now, const BridgeOut& out);
  void publish(Publication publication, const std::string& type, const BridgeOut& out);
  /// Ends all that has that token: a watch, an ask, a publication that has not left yet.
  void forget(std::uint64_t token, Now now);
  /// Of an adapter that is gone: nobody waits for it, and nobody could still stop it.
  void forget_adapter();
  void drop(std::uint64_t key) { output_.bytes += to_bytes({Word::drop, {std::to_string(key)}}); }
  /// Neither is it published later.
  void drop_published();
  void on_worker_message(WorkerMessage& message, Now now, Outbox& outbox);
  void on_alive(bool up, const std::string& detail, Now now, Outbox& out);
  void on_type(const std::string& topic, const std::string& type, Now now, const BridgeOut& out);
  Result<RosTypePtr> type_of(const std::string& name);
  void end_publish(std::uint64_t key, const std::optional<Error>& error, const BridgeOut& out);
  void expire(Now now, const BridgeOut& out);
  [[nodiscard]] BridgeOut out_of(Outbox& outbox) { return {settings_.id, adapter_, outbox, output_}; }
  void forget_commands();
  void set_state(bool up, const std::string& detail, Now now, Outbox& out);
  void send_state(Now now, Outbox& out);

  BridgeSettings settings_;
  TypeStore store_;
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
  Listeners listeners_;
};

}  // namespace trb::ros
