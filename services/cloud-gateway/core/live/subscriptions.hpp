// All clients of the live stream: when frames are made, and by whom they are to be taken.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/live/client_feed.hpp"

namespace trb::gateway {

using ClientId = std::uint64_t;

class Subscriptions {
 public:
  static constexpr std::size_t kMaxClients = 1000;
  static constexpr Duration kFrame = std::chrono::milliseconds(100);

  /// `instance`: random, of this start; never 0. Book and encoder outlive it.
  Subscriptions(const RowBook& book, RowEncoder& encoder, std::uint64_t instance)
      : blocks_(book, encoder), instance_(instance) {}

  /// Errors: queue_full.
  Result<ClientId> open();
  void close(ClientId client);
  /// Who may see the topic was checked before. Errors: unknown_target (no such client), queue_full.
  Status subscribe(ClientId client, const Topic& topic, std::optional<Resume> resume = {});
  void unsubscribe(ClientId client, const Topic& topic);

  /// A message of the tap, as it is sent. To be made only while somebody watches.
  void add_message(Bytes message);
  [[nodiscard]] bool wants_messages() const;
  /// The runs whose whole somebody looks at.
  [[nodiscard]] std::set<std::string> watched_runs() const;

  /// The clients that have a frame to take since now. Before the deadline it does nothing.
  std::vector<ClientId> pump(Now now);
  std::optional<Frame> take(ClientId client);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  [[nodiscard]] std::uint64_t instance() const { return instance_; }
  [[nodiscard]] const BlockMaker& blocks() const { return blocks_; }

 private:
  [[nodiscard]] std::optional<NoticeKind> why_not(const Topic& topic, const Resume& resume) const;
  [[nodiscard]] bool has_news() const;

  BlockMaker blocks_;
  MessageLane lane_;
  std::uint64_t instance_;
  std::map<ClientId, ClientFeed> clients_;
  ClientId last_client_ = 0;
  std::optional<MonotonicTime> pumped_at_;
  std::uint64_t pumped_head_ = 0;
  std::uint64_t pumped_messages_ = 0;
};

}  // namespace trb::gateway
