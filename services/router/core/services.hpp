// The node's own bus: which connection is which service, and which service takes which subtype.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "proto/bodies/bus.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/sent_requests.hpp"

namespace trb::router {

/// What a connection of the bus may do.
enum class Member : unsigned char {
  service,
  probe,    ///< the command line
  visitor,  ///< of a service's key: asks how the services are, and nothing else
};

struct Connection {
  ServiceHello hello;
  Member member = Member::service;
  std::uint16_t slot = 0;
  MonotonicTime since;
  MonotonicTime last_heard;
  SentRequests sent{};  ///< belongs to the slot: a new connection has requested nothing
};

class Services {
 public:
  explicit Services(std::uint16_t first_slot) : next_slot_(first_slot) {}

  /// Takes a connection in; a service has one visitor, the last. Errors: already_claimed (the holder of the service or
  /// of a subtype is still there), queue_full, bad_value, not_permitted (an operator's service claims a subtype of the
  /// middleware). The caller must first have freed a holder whose connection is gone.
  Result<std::uint16_t> welcome(ConnectionId connection, const ServiceHello& hello, Member member, MonotonicTime now);
  void forget(ConnectionId connection);
  void on_received(ConnectionId connection, MonotonicTime now);

  [[nodiscard]] const Connection* find(ConnectionId connection) const;
  [[nodiscard]] SentRequests* sent_by(ConnectionId connection);
  [[nodiscard]] std::optional<ConnectionId> holder(std::string_view service) const;
  [[nodiscard]] std::optional<ConnectionId> by_subtype(std::string_view subtype) const;
  /// The connections that want a copy of information of that subtype.
  [[nodiscard]] const std::vector<ConnectionId>& subscribers(std::string_view subtype) const;
  [[nodiscard]] std::optional<ConnectionId> by_slot(std::uint16_t slot) const;
  [[nodiscard]] const std::map<ConnectionId, Connection>& all() const { return connections_; }

 private:
  [[nodiscard]] Status may_come(const ServiceHello& hello, Member member) const;
  [[nodiscard]] Status may_take_subtypes(const ServiceHello& hello) const;
  void forget_visitor(const std::string& name);
  void add_service(ConnectionId connection, const ServiceHello& hello);
  std::uint16_t free_slot();

  std::map<ConnectionId, Connection> connections_;
  std::map<std::string, ConnectionId, std::less<>> subtypes_;
  std::map<std::string, std::vector<ConnectionId>, std::less<>> subscribers_;
  std::map<std::string, ConnectionId, std::less<>> services_;
  std::map<std::uint16_t, ConnectionId> slots_;
  std::uint16_t next_slot_;
};

}  // namespace trb::router
