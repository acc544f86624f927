// Fleets in memory in which two members communicate by a relay, for the tests.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/security/relay_box.hpp"
#include "services/router/test/test_fleet.hpp"

namespace trb::router {

/// ant and bee cannot reach each other; both reach the cloud, which relays.
struct Triangle {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode* ant = nullptr;
  TestNode* bee = nullptr;
  LinkId cloud_link = 0;  ///< bee's

  Triangle() {
    fleet.cut("ant", "bee");
    fleet.cut("bee", "ant");
    ant = &fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
    bee = &fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
    serve(fleet, *ant);
    serve(fleet, *bee);
    fleet.run(std::chrono::seconds(3));
    cloud_link = bee->link_to("cloud");
  }

  /// A scheduler on the node's bus, connection 1.
  static void serve(TestFleet& fleet, TestNode& node) {
    Effects effects;
    node.core->bus().on_hello(1, {"scheduler", {"numbered"}, 5, 100, "1"}, "scheduler", fleet.now, effects);
    fleet.carry_out(node, effects);
  }

  /// Puts a message on the link from one node to another, as if the first node's router had sent it.
  void put(TestNode& from, const std::string& to, const Message& message) {
    Effects effects;
    effects.add(LinkSend{from.link_to(to), message});
    fleet.carry_out(from, effects);
    fleet.run(2 * kStep);
  }

  /// That scheduler sends a message, as the shell handles it.
  static void say(TestFleet& fleet, TestNode& node, std::uint64_t number, const std::string& to = "bee") {
    Message message;
    message.type = MessageType::information;
    message.subtype = "numbered";
    message.source = node.id;
    message.target = to;
    const auto welcome = std::find_if(node.bus.begin(), node.bus.end(), [](const BusSend& sent) {
      return sent.message.subtype == ServiceWelcome::kSubtype;
    });
    message.id = std::uint64_t{decode<ServiceWelcome>(welcome->message.data)->slot} << 48U | number;
    message.data = std::to_string(number);
    fleet.forward(node, 1, message);
  }
  void say(std::uint64_t number) { say(fleet, *ant, number); }

  static const Route* route(const TestNode& node, const std::string& to, const TestFleet& fleet) {
    static RouteTable table;
    table = node.core->answers().route_table(fleet.now);
    for (const Route& row : table.routes) {
      if (row.id == to) return &row;
    }
    return nullptr;
  }

  Message numbered(const std::string& text, MessageType type = MessageType::information) const {
    Message message;
    message.type = type;
    message.subtype = "numbered";
    message.source = "ant";
    message.target = "bee";
    message.id = 77;
    message.data = text;
    return message;
  }

  /// A command of the scheduler on that node's bus.
  Message command(TestNode& node) const {
    Message message = numbered("x", MessageType::command);
    const auto welcome = std::find_if(node.bus.begin(), node.bus.end(), [](const BusSend& sent) {
      return sent.message.subtype == ServiceWelcome::kSubtype;
    });
    message.id = std::uint64_t{decode<ServiceWelcome>(welcome->message.data)->slot} << 48U | 77;
    return message;
  }
  /// The codes of all Nacks to the services of a node.
  static std::vector<std::string> nacks(const TestNode& node) {
    std::vector<std::string> out;
    for (const BusSend& sent : node.bus) {
      if (sent.message.subtype == Nack::kSubtype) out.push_back(decode<Nack>(sent.message.data)->code);
    }
    return out;
  }

  /// What ant's shell would send to the relay.
  Relaying wrap(const Message& message) {
    auto out = ant->core->relays().wrap(1, "bee", header_of(message), encode_frame(message), fleet.now);
    REQUIRE(out.ok());
    return *out;
  }

  /// As if the cloud had passed this record on to bee.
  void hand_to_bee(const SignedRecord& record) {
    put(cloud, "bee", make_message(MessageType::information, "cloud", "bee", Relayed{record}));
  }
  SignedRecord signed_by_ant(const RelayedFrame& frame) {
    return sign(kSignedRelayed, "ant", fleet.authority.fleet.id(), encode(frame), ant->keys.identity);
  }
  /// As ant would make it; ant's own counts are far lower.
  RelayedFrame frame(std::uint64_t count, const Message& inner) const {
    const Bytes key = relay_key(ant->keys.link, bee->keys.link.public_key);
    return {"bee", 1, 1, 1000 + count, fleet.now.utc.ns + 5'000'000'000, {lock_relayed(key, encode_frame(inner))}};
  }
  [[nodiscard]] std::size_t delivered() const { return bee->told("numbered"); }
};

/// ant and bee reach each other by two relays, cloud and dock.
struct TwoRelays {
  TestFleet fleet;
  TestNode* ant = nullptr;
  TestNode* bee = nullptr;
  std::string first;  ///< carries ant's messages
  std::string other;

  TwoRelays() {
    fleet.cut("ant", "bee");
    fleet.cut("bee", "ant");
    fleet.start("cloud", {.beacon = false, .relay = true});
    fleet.start("dock", {.beacon = false, .seeds = {"cloud"}, .relay = true});
    ant = &fleet.start("ant", {.beacon = false, .seeds = {"cloud", "dock"}});
    bee = &fleet.start("bee", {.beacon = false, .seeds = {"cloud", "dock"}});
    Triangle::serve(fleet, *ant);
    Triangle::serve(fleet, *bee);
    fleet.run(std::chrono::seconds(4));
    first = Triangle::route(*ant, "bee", fleet)->via;
    other = first == "cloud" ? "dock" : "cloud";
    REQUIRE_FALSE(first.empty());
  }
  /// A command that ant gave its relay and that the relay did not pass on; returns its count.
  std::uint64_t lost() {
    const Message message{
        .type = MessageType::command, .subtype = "numbered", .source = "ant", .target = "bee", .id = 5, .data = {}};
    const auto out = ant->core->relays().wrap(1, "bee", header_of(message), encode_frame(message), fleet.now);
    REQUIRE(out.ok());
    return decode<RelayedFrame>(decode<Relayed>(out->message.data)->record.payload.bytes)->count;
  }
  void refuse(const std::string& relay, const std::string& target, std::uint64_t count, Errc reason) {
    const LinkId link = ant->link_to(relay);
    fleet.arrive(*ant, link, ant->core->table().link(link)->heard + 1,
                 make_message(MessageType::information, relay, "ant",
                              RelayRefused{target, count, std::string(errc_name(reason))}));
  }
  [[nodiscard]] std::string via() const { return Triangle::route(*ant, "bee", fleet)->via; }
};

}  // namespace trb::router
