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

/// A record of that kind as its maker on the node would have it signed.
inline Bytes payload_of(std::string_view kind, const std::string& node) {
  if (kind == kSignedResult) {
    TaskResult result;
    result.robot = node;
    return encode(result);
  }
  if (kind == kSignedRunStart) {
    RunStart start;
    start.submitter = node;
    return encode(start);
  }
  if (kind == kSignedChoice) {
    Choice choice;
    choice.by = node;
    return encode(choice);
  }
  if (kind == kSignedDecision) {
    trb::Decision decision;
    decision.by = node;
    return encode(decision);
  }
  if (kind == kSignedRunPause) return encode(PauseOrder{"r", 1, true, node, "", 0});
  return encode(AbortOrder{"r", node, "", 0});
}

}  // namespace trb::router
