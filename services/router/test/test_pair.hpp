// Two linked nodes, one of them with services on its bus, for the tests of routing.
#pragma once

#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

namespace trb::router {

/// Two linked nodes, without services.
struct LinkedPair {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");

  LinkedPair() { fleet.run(Seconds(1)); }
  /// A service, or a probe, at ant.
  void hello(ConnectionId from, const std::string& service, std::vector<std::string> subtypes = {},
             bool probe = false) {
    Effects effects;
    ant.core->bus().on_hello(from, {service, std::move(subtypes), 5, 100, "1"},
                             probe ? kProbe : std::string_view(service), fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
};

/// Ant has a mode-adapter (connection 1) and a scheduler (connection 2) that takes "baton".
struct RoutedPair : LinkedPair {
  RoutedPair() {
    hello(1, "mode-adapter", {"stop"});
    hello(2, "scheduler", {"baton", "execution_state"});
  }
  std::uint64_t slot(std::size_t welcome) const {
    std::vector<std::uint64_t> slots;
    for (const BusSend& send : ant.bus) {
      if (send.message.subtype == ServiceWelcome::kSubtype)
        slots.push_back(decode<ServiceWelcome>(send.message.data)->slot);
    }
    return slots.at(welcome);
  }
  Message local(const std::string& target, const std::string& subtype, MessageType type = MessageType::command) const {
    return {.type = type, .subtype = subtype, .source = "ant", .target = target, .id = slot(0) << 48U | 9U, .data = {}};
  }
  Message remote(const std::string& subtype, MessageType type = MessageType::command) const {
    return {.type = type, .subtype = subtype, .source = "bee", .target = "ant", .id = 9, .data = {}};
  }
  /// A service requests something; the request goes out.
  Routing ask(ConnectionId from, std::uint64_t id, const std::string& target, const std::string& subtype = "move",
              MessageType type = MessageType::command) {
    Message question{.type = type, .subtype = subtype, .source = "ant", .target = target, .id = id, .data = {}};
    return ant.core->routing().from_bus(from, header_of(question));
  }
  Routing route(const Message& message) { return ant.core->routing().from_bus(1, header_of(message)); }
  Routing come(const Message& message) {
    const LinkId link = ant.link_to("bee");
    return fleet.arrive(ant, link, ant.core->table().link(link)->heard + 1, message);
  }
  std::size_t nacks() const { return ant.told(Nack::kSubtype); }
};

}  // namespace trb::router
