// The node's own bus: which connection is which service, and which service takes which subtype.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "proto/bodies/bus.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/sent_requests.hpp"

namespace trb::router {

constexpr std::string_view kSensorBus = "sensor-bus";
constexpr std::string_view kModeAdapter = "mode-adapter";

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
  std::string note{};   ///< what it says of itself while it works
};

class Services {
 public:
  explicit Services(std::uint16_t first_slot) : next_slot_(first_slot) {}
  Services(const Services&) = delete;
  Services& operator=(const Services&) = delete;

  /// Takes a connection in; a service has one visitor, the last. Errors: already_claimed (the holder of the service or
  /// of a subtype is still there), queue_full, bad_value, not_permitted (an operator's service claims a subtype of the
  /// middleware). The caller must first have freed a holder whose connection is gone.
  Result<std::uint16_t> welcome(ConnectionId connection, const ServiceHello& hello, Member member, MonotonicTime now);
  void forget(ConnectionId connection);
  void on_received(ConnectionId connection, MonotonicTime now);
  void on_note(ConnectionId connection, const std::string& note);

  [[nodiscard]] const Connection* find(ConnectionId connection) const;
  [[nodiscard]] SentRequests* sent_by(ConnectionId connection);
  [[nodiscard]] std::optional<ConnectionId> holder(std::string_view service) const;
  /// The connections of the services that report the node's profile; nullptr: none. They are asked for at each step of
  /// the router, so no name is looked up.
  [[nodiscard]] const Connection* sensor_bus() const { return sensor_bus_; }
  [[nodiscard]] const Connection* mode_adapter() const { return mode_adapter_; }
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
  void find_reporters();
  std::uint16_t free_slot();

  std::map<ConnectionId, Connection> connections_;
  std::map<std::string, ConnectionId, std::less<>> subtypes_;
  std::map<std::string, std::vector<ConnectionId>, std::less<>> subscribers_;
  std::map<std::string, ConnectionId, std::less<>> services_;
  std::map<std::uint16_t, ConnectionId> slots_;
  const Connection* sensor_bus_ = nullptr;  ///< a row of connections_
  const Connection* mode_adapter_ = nullptr;
  std::uint16_t next_slot_;
};

}  // namespace trb::router
