// All clients of the live stream: when frames are made, and which clients have one to take.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/cloud-gateway/core/live/client_feed.hpp"
#include "services/cloud-gateway/core/live/sensor_streams.hpp"

namespace trb::gateway {

using ClientId = std::uint64_t;

class Subscriptions {
 public:
  static constexpr std::size_t kMaxClients = 1000;
  static constexpr Duration kFrame = std::chrono::milliseconds(100);

  /// `instance`: random for each start, never 0. Book and encoder must outlive it.
  Subscriptions(const RowBook& book, RowEncoder& encoder, std::uint64_t instance)
      : blocks_(book, encoder), instance_(instance) {}

  /// Errors: queue_full.
  Result<ClientId> open();
  void close(ClientId client);
  /// The caller has checked the client's rights. Errors: unknown_target (no such client), queue_full (topics
  /// of this client; sensors of all clients).
  Status subscribe(ClientId client, const Topic& topic, std::optional<Resume> resume = {});
  void unsubscribe(ClientId client, const Topic& topic);

  /// An encoded message of the tap. Make it only while wants_messages() is true.
  void add_message(Bytes message);
  [[nodiscard]] bool wants_messages() const;
  /// The runs that are there and that a client watches in full. Ask now and then: one that comes is among them from
  /// then on.
  [[nodiscard]] std::set<std::string> watched_runs() const;
  /// True if a client watches the fleet or a robot; one that has stalled watches none.
  [[nodiscard]] bool watches_robots(Now now) const;
  /// The sensors that are there and that a client watches; one that has stalled watches none. Ask now and then: one
  /// that comes is among them from then on.
  [[nodiscard]] std::set<SensorId> watched_sensors(Now now) const;
  /// True if a topic was added or left since the last call.
  bool take_topics_changed() { return std::exchange(topics_changed_, false); }
  [[nodiscard]] bool topics_changed() const { return topics_changed_; }

  /// The clients with a new frame to take. Does nothing before the deadline. `silent`: what each frame tells.
  std::vector<ClientId> pump(Now now, const RowSources& silent = {});
  std::optional<Frame> take(ClientId client);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  [[nodiscard]] std::uint64_t instance() const { return instance_; }
  [[nodiscard]] const BlockMaker& blocks() const { return blocks_; }

 private:
  [[nodiscard]] std::optional<NoticeKind> why_not(const Topic& topic, const Resume& resume) const;
  [[nodiscard]] bool has_changes() const;
  [[nodiscard]] Status check_room(const Topic& topic) const;
  void add_sensors(const ClientFeed& client, std::set<SensorId>& out) const;
  [[nodiscard]] bool has_sensor(const Topic& topic) const;

  BlockMaker blocks_;
  MessageLane lane_;
  std::uint64_t instance_;
  std::map<ClientId, ClientFeed> clients_;
  ClientId last_client_ = 0;
  bool topics_changed_ = false;
  std::optional<MonotonicTime> pumped_at_;
  std::uint64_t pumped_head_ = 0;
  std::uint64_t pumped_messages_ = 0;
};

}  // namespace trb::gateway
