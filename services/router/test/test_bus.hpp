// A node's bus, for tests: connections come, go and ask, each by hand.
#pragma once

#include "services/router/test/test_fleet.hpp"

namespace trb::router {

struct Bus {
  /// A cloud's services have signed what no robot's may.
  explicit Bus(Role role = {}) : ant(fleet.start("ant", {.beacon = false, .role = role})) {}

  TestFleet fleet;
  TestNode& ant;

  std::string hello(ConnectionId from, const std::string& service, std::vector<std::string> subtypes = {},
                    bool probe = false) {
    return come_as(probe ? kProbe : std::string_view(service), from, service, std::move(subtypes));
  }
  std::string come_as(std::string_view as, ConnectionId from, const std::string& service,
                      std::vector<std::string> subtypes = {}) {
    Effects effects;
    ant.core->bus().on_hello(from, {service, std::move(subtypes), 5, 100, "1"}, as, fleet.now, effects);
    fleet.carry_out(ant, effects);
    const Message& last = ant.bus.back().message;
    return last.subtype == Nack::kSubtype ? decode<Nack>(last.data)->code : last.subtype;
  }
  void gone(ConnectionId from) {
    Effects effects;
    ant.core->on_connection_gone(from, fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  template <class T>
  std::string ask(ConnectionId from, const T& body) {
    Effects effects;
    ant.core->forwarding().on_bus_message(from, make_message(MessageType::request, "ant", "ant", body), fleet.now,
                                          effects);
    fleet.carry_out(ant, effects);
    const Message& last = ant.bus.back().message;
    return last.subtype == Nack::kSubtype ? decode<Nack>(last.data)->code : last.subtype;
  }
};

}  // namespace trb::router
