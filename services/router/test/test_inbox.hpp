// A node to whose inbox the test connects: it sends Hello as the bee, or as any other node.
#pragma once

#include "services/router/test/test_fleet.hpp"

namespace trb::router {

struct Inbox {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  TestKeys bee = fleet.keys("bee");

  Hello hello(const TestKeys& keys) const {
    return {keys.record, 3, "10.0.0.2:45000", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  }

  void say(LinkId link, const Bytes& key, const Message& message, std::uint64_t sequence = 1) {
    Effects effects;
    ant.core->inbox().on_message(link, key, message, sequence, fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  void say_hello(LinkId link, const TestKeys& keys, const std::string& source = "bee") {
    say(link, keys.link.public_key, make_message(MessageType::information, source, "", hello(keys)));
  }
  bool admit(const Bytes& key) {
    Effects effects;
    const bool good = ant.core->admission().admit(key, fleet.now, effects);
    fleet.carry_out(ant, effects);
    return good;
  }
};

}  // namespace trb::router
