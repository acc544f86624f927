// The messages of this router itself: numbered, never larger than their receiver accepts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "proto/body.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/local_node.hpp"
#include "services/router/core/peers.hpp"

namespace trb::router {

class OwnMessages {
 public:
  explicit OwnMessages(const LocalNode& node) : node_(node) {}

  /// The number of a message of this router.
  std::uint64_t next_id() { return ++last_id_; }
  /// Information of this router whose data is already encoded.
  Message plain(std::string_view subtype, const std::string& target, Bytes data);
  /// Nothing if the receiver would have to refuse it (counted, logged); the requester (`reply_to`) then gets a Nack
  /// instead.
  std::optional<Message> make(const std::string& target, std::uint64_t reply_to, const Body& body, Effects& out);
  /// To the other side of a link.
  void send(const Link& link, const Body& body, Effects& out);
  /// To a connection of the own bus.
  void send_bus(ConnectionId to, std::uint64_t reply_to, const Body& body, Effects& out);
  /// The Nack of a message that could not be delivered.
  Message nack(const HeaderView& header, Errc reason);
  /// The same for another node, if a Nack is due there; counted.
  std::optional<Message> nack_elsewhere(const HeaderView& header, Errc reason, Effects& out);

 private:
  const LocalNode& node_;
  std::uint64_t last_id_ = 0;
};

}  // namespace trb::router
