// The node's own bus: services come and go, are notified and answered, and have records signed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/body.hpp"
#include "services/router/core/own_messages.hpp"
#include "services/router/core/services.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// connection | event                                   | next
/// -----------|-----------------------------------------|----------------------------------------------------------
/// -          | Hello of a service of node.json         | service: its subtypes are its own
/// -          | Hello of a probe                        | probe, if there is room
/// -          | Hello of a service's visitor            | visitor, if there is room; an earlier one: -
/// -          | Hello by another name (invalid)         | -, Nack
/// any        | Hello, the same again                   | as before, with the same slot
/// any        | its connection ends                     | -
/// probe, visitor | silent for a lease (expired)        | -, HelloWanted
class LocalBus {
 public:
  LocalBus(const LocalNode& node, OwnMessages& messages, const TrustStore& trust)
      : node_(node), messages_(messages), trust_(trust), services_(node.config().first_slot) {}

  /// `proven`: the identity that the connection's socket or key proves: a service, or kProbe.
  void on_hello(ConnectionId from, const ServiceHello& hello, std::string_view proven, Now now, Effects& out);
  /// Returns the name of the service that ended with this connection, if it was one.
  std::optional<std::string> on_gone(ConnectionId connection, Effects& out);
  void on_received(ConnectionId from, Now now) { services_.on_received(from, now.mono); }

  void on_note(ConnectionId from, const std::string& note) { services_.on_note(from, note); }

  [[nodiscard]] const Services& services() const { return services_; }
  [[nodiscard]] bool is_full() const { return services_.all().size() >= kMaxConnections; }
  [[nodiscard]] bool knows(ConnectionId connection) const { return services_.find(connection) != nullptr; }
  /// The connections that want a copy of this message, besides the one that takes it.
  [[nodiscard]] const std::vector<ConnectionId>& copies_for(const HeaderView& header) const;

  /// Sends it to the service that takes it, and to those that want a copy.
  void notify(const Body& body, Effects& out);
  void answer(ConnectionId to, const Message& request, const Body& body, Effects& out);
  /// Counts the refusal, and sends a Nack if an answer is due.
  void deny(ConnectionId to, const Message& request, const Error& error, Effects& out);
  /// Answers a message that could not be delivered.
  void nack(ConnectionId from, const HeaderView& header, Errc reason, Effects& out);

  /// A message of this connection leaves; `whom`: who may answer it.
  void note_request(ConnectionId from, const HeaderView& header, Party whom);
  /// The connection that waits for the answer to the message with this id, or nullptr.
  [[nodiscard]] const Connection* requester_of(std::uint64_t reply_to) const;

  /// Signs a record with the node's key, for the one service that may make it.
  void sign_for(ConnectionId from, const Message& message, const SignRequest& request, Effects& out);

 private:
  [[nodiscard]] Status may_be(const ServiceHello& hello, std::string_view proven) const;
  [[nodiscard]] Status may_sign_for(const Connection& from, const SignRequest& request) const;
  void forget_silent_probes(Now now, Effects& out);
  void tell_revoked(ConnectionId to, const ServiceHello& hello, Effects& out);
  void refuse(ConnectionId from, const ServiceHello& hello, const Error& error, Effects& out);

  const LocalNode& node_;
  OwnMessages& messages_;
  const TrustStore& trust_;
  Services services_;
};

}  // namespace trb::router
