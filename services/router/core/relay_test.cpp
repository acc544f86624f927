// Relays: two members that cannot reach each other talk by a third. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/core/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;

namespace {

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
    fleet.run(Seconds(3));
    cloud_link = bee->link_to("cloud");
  }

  /// A scheduler on the node's bus, connection 1.
  static void serve(TestFleet& fleet, TestNode& node) {
    Effects effects;
    node.core->on_service_hello(1, {"scheduler", {"numbered"}, 5, 100, "1"}, "scheduler", fleet.now, effects);
    fleet.carry_out(node, effects);
  }

  /// Put on the link from one node to another, as if the first one's router had.
  void put(TestNode& from, const std::string& to, const Message& message) {
    Effects effects;
    effects.add(LinkSend{from.link_to(to), message});
    fleet.carry_out(from, effects);
    fleet.run(2 * kStep);
  }

  /// What the shell does with a message of that scheduler.
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
    const Routing decision = node.core->route_local(1, header_of(message));
    Effects effects;
    if (decision.to == Routing::To::relay) {
      auto relaying = node.core->relay_out(to, encode_frame(message), message.remaining_ms, fleet.now_of(node));
      REQUIRE(relaying.ok());
      effects.add(LinkSend{relaying->link, relaying->message});
    } else if (decision.to == Routing::To::peer) {
      effects.add(LinkSend{decision.link, message});
    }
    fleet.carry_out(node, effects);
  }
  void say(std::uint64_t number) { say(fleet, *ant, number); }

  static const Route* route(const TestNode& node, const std::string& to, const TestFleet& fleet) {
    static RouteTable table;
    table = node.core->route_table(fleet.now);
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

  /// What ant's shell would send to the relay.
  Relaying wrap(const Message& message) {
    auto out = ant->core->relay_out("bee", encode_frame(message), message.remaining_ms, fleet.now);
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
  RelayedFrame frame(std::uint64_t count, const Message& inner) const {
    return {"bee", 1, 1, count, fleet.now.utc.ns + 5'000'000'000, {encode_frame(inner)}};
  }
  [[nodiscard]] std::size_t delivered() const { return bee->told("numbered"); }
};

}  // namespace

TEST_CASE("two that cannot reach each other are ONLINE by the relay, and know each other's boot") {
  Triangle three;
  const Route* bee = Triangle::route(*three.ant, "bee", three.fleet);
  REQUIRE(bee != nullptr);
  CHECK(bee->state == "ONLINE");
  CHECK(bee->via == "cloud");
  CHECK(bee->link == 0);
  CHECK(bee->boot == 1);
  CHECK(Triangle::route(*three.bee, "ant", three.fleet)->via == "cloud");
  CHECK(Triangle::route(*three.ant, "cloud", three.fleet)->via.empty());
}

TEST_CASE("a message goes by the relay once, to whom it is for, and its answer comes back that way") {
  Triangle three;
  const Relaying relaying = three.wrap(three.numbered("1"));
  CHECK(relaying.link == three.ant->link_to("cloud"));
  three.put(*three.ant, "cloud", relaying.message);
  three.fleet.run(milliseconds(100));
  CHECK(three.delivered() == 1);
  CHECK(three.bee->bus.back().message.source == "ant");
  CHECK(three.bee->bus.back().message.data == "1");
  CHECK(three.cloud.count("relayed.sent") == 1);
  CHECK(three.bee->count("relayed.received") == 1);
}

TEST_CASE("what is replayed, forged, late or for another boot is refused, each by a name of its own") {
  Triangle three;
  const auto now = three.fleet.now.utc.ns;
  const RelayedFrame good = three.frame(5, three.numbered("x"));
  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.delivered() == 1);

  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.bee->count("refused.relayed_replayed") == 1);
  three.hand_to_bee(three.signed_by_ant(three.frame(4, three.numbered("x"))));
  CHECK(three.bee->count("refused.relayed_replayed") == 2);

  SignedRecord forged = three.signed_by_ant(three.frame(6, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  three.hand_to_bee(forged);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 1);
  SignedRecord other = sign(kSignedRelayed, "ant", three.fleet.authority.fleet.id(),
                            encode(three.frame(6, three.numbered("x"))), three.cloud.keys.identity);
  three.hand_to_bee(other);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 2);
  SignedRecord purpose = sign(kSignedResult, "ant", three.fleet.authority.fleet.id(),
                              encode(three.frame(6, three.numbered("x"))), three.ant->keys.identity);
  three.hand_to_bee(purpose);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 3);

  RelayedFrame late = three.frame(6, three.numbered("x"));
  late.expires = now - 1;
  three.hand_to_bee(three.signed_by_ant(late));
  CHECK(three.bee->count("refused.relayed_late") == 1);
  RelayedFrame boot = three.frame(6, three.numbered("x"));
  boot.target_boot = 2;
  three.hand_to_bee(three.signed_by_ant(boot));
  CHECK(three.bee->count("refused.relayed_other_boot") == 1);

  Message theft = three.numbered("x");
  theft.source = "cloud";
  three.hand_to_bee(three.signed_by_ant(three.frame(7, theft)));
  CHECK(three.bee->count("refused.relayed_source_mismatch") == 1);
  Message astray = three.numbered("x");
  astray.target = "cat";
  three.hand_to_bee(three.signed_by_ant(three.frame(8, astray)));
  CHECK(three.bee->count("refused.relayed_wrong_target") == 1);
  RelayedFrame garbage = three.frame(9, three.numbered("x"));
  garbage.frame.bytes = "nothing";
  three.hand_to_bee(three.signed_by_ant(garbage));
  CHECK(three.bee->count("refused.relayed_malformed") == 1);
  SignedRecord unknown = three.signed_by_ant(three.frame(10, three.numbered("x")));
  unknown.signer = "nobody";
  three.hand_to_bee(unknown);
  CHECK(three.bee->count("refused.relayed_unknown_signer") == 1);
  CHECK(three.delivered() == 1);

  three.hand_to_bee(three.signed_by_ant(three.frame(11, three.numbered("y"))));
  CHECK(three.delivered() == 2);
}

TEST_CASE("words of a link and of one node's own services are not taken by a relay") {
  Triangle three;
  std::uint64_t count = 20;
  for (const char* word : {"hello", "keep_alive", "goodbye", "node_profile", "relayed", "neighbours", "execute"}) {
    CAPTURE(word);
    Message message = three.numbered("x");
    message.subtype = word;
    const std::uint64_t before = three.bee->count("refused.not_permitted");
    three.hand_to_bee(three.signed_by_ant(three.frame(++count, message)));
    CHECK(three.bee->count("refused.not_permitted") == before + 1);
  }
  CHECK(three.bee->link_to("cloud") == three.cloud_link);
}

TEST_CASE("a role's rights are the same by a relay: what only a robot can know is taken from no cloud") {
  Triangle three;
  const TestKeys office = three.fleet.authority.sign_node("office", Role::cloud);
  const Neighbours told{{{office.record, 1, "office", "1", true, {}}}, {}};
  three.put(three.cloud, "bee", make_message(MessageType::information, "cloud", "bee", told));
  Message fault = three.numbered("x");
  fault.source = "office";
  fault.subtype = "robot_fault";
  three.hand_to_bee(
      sign(kSignedRelayed, "office", three.fleet.authority.fleet.id(), encode(three.frame(1, fault)), office.identity));
  CHECK(three.bee->count("refused.not_permitted") == 1);
}

TEST_CASE("a relay passes on what its own peer signed, one hop and no more, and a node that is none passes nothing") {
  Triangle three;
  const auto from_ant = [&](const SignedRecord& record) {
    three.put(*three.ant, "cloud", make_message(MessageType::information, "ant", "cloud", Relayed{record}));
  };
  const RelayedFrame frame = three.frame(30, three.numbered("x"));
  from_ant(sign(kSignedRelayed, "bee", three.fleet.authority.fleet.id(), encode(frame), three.bee->keys.identity));
  CHECK(three.cloud.count("refused.relayed_second_hop") == 1);
  RelayedFrame for_cat = frame;
  for_cat.target = "cat";
  three.hand_to_bee(three.signed_by_ant(for_cat));
  CHECK(three.bee->count("refused.relayed_no_relay") == 1);
  Message told = make_message(MessageType::information, "bee", "cloud", Neighbours{});
  three.put(*three.bee, "cloud", told);
  CHECK(three.cloud.count("refused.not_permitted") == 1);
}

TEST_CASE("a target that the relay has lost is Nacked by it; a message over 512 kB never leaves") {
  Triangle three;
  const Relaying relaying = three.wrap(three.numbered("x", MessageType::command));
  three.fleet.stop("bee");
  three.fleet.run(milliseconds(20));
  Effects effects;
  three.cloud.core->on_link_ended(three.cloud.link_to("bee"), LinkEnd::disconnected, three.fleet.now, effects);
  three.fleet.carry_out(three.cloud, effects);
  three.put(*three.ant, "cloud", relaying.message);
  CHECK(three.cloud.count("dropped.peer_unreachable") == 1);
  three.fleet.run(milliseconds(200));
  CHECK(three.ant->peer("bee")->relays.empty());
  const auto gone = three.ant->core->relay_out("bee", encode_frame(three.numbered("x")), 1000, three.fleet.now);
  CHECK(gone.error().code == Errc::peer_unreachable);

  Triangle again;
  const auto large =
      again.ant->core->relay_out("bee", encode_frame(again.numbered(std::string(600'000, 'x'))), 1000, again.fleet.now);
  CHECK(large.error().code == Errc::too_large);
}

TEST_CASE("the relay's end is a lease, then the peer is expired; a link of one's own is preferred at once") {
  Triangle three;
  three.fleet.heal();
  three.fleet.run(Seconds(6));
  CHECK(three.ant->link_to("bee") != 0);
  CHECK(three.ant->link_to("bee") == three.bee->link_to("ant"));
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->via.empty());
  CHECK(three.ant->count("peer_expired") == 0);

  Triangle lost;
  lost.fleet.stop("cloud");
  lost.fleet.run(Seconds(2));
  CHECK(Triangle::route(*lost.ant, "bee", lost.fleet)->state == "CONNECTION_BROKEN");
  lost.fleet.run(Seconds(11));
  CHECK(Triangle::route(*lost.ant, "bee", lost.fleet)->state == "OFFLINE");
  CHECK(lost.ant->count("peer_expired") == 2);
}

TEST_CASE("one seed is enough to find a fleet: the relay tells whom it reaches, and they dial each other") {
  TestFleet fleet;
  fleet.start("cloud", {.beacon = false, .relay = true});
  const std::vector<std::string> robots = {"ant", "bee", "cat", "dog"};
  for (const std::string& id : robots) fleet.start(id, {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(4));
  for (const std::string& a : robots) {
    for (const std::string& b : robots) {
      if (a == b) continue;
      CHECK(fleet.at(a).link_to(b) != 0);
      CHECK(fleet.at(a).link_to(b) == fleet.at(b).link_to(a));
    }
  }
}

TEST_CASE("a cut that comes and goes: what is sent meanwhile arrives once or not at all, and nowhere else") {
  Triangle three;
  std::uint64_t number = 0;
  const auto send_for = [&](Duration time) {
    for (Duration spent{}; spent < time; spent += 5 * kStep) {
      three.say(++number);
      three.fleet.run(5 * kStep);
    }
  };
  for (int round = 0; round < 4; ++round) {
    three.fleet.heal();
    send_for(Seconds(7));
    CHECK(three.ant->link_to("bee") != 0);
    three.fleet.cut("ant", "bee");
    if (round % 2 == 0) three.fleet.cut("bee", "ant");
    send_for(Seconds(15));
    CHECK(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  }
  std::map<Bytes, int> times;
  for (const Message& message : three.bee->delivered) ++times[message.data];
  for (const BusSend& send : three.bee->bus) {
    if (send.message.subtype == "numbered") ++times[send.message.data];
  }
  CHECK(times.size() > number / 3);
  for (const auto& [text, count] : times) CHECK_MESSAGE(count == 1, text);
  CHECK(three.cloud.delivered.empty());
  CHECK(three.cloud.told("numbered") == 0);
  CHECK(three.ant->told("numbered") == 0);
  CHECK(three.bee->count("refused.relayed_replayed") == 0);
}

TEST_CASE("a node that dies is expired about a lease later, though a relay says that it reached it") {
  Triangle three;
  three.fleet.heal();
  three.fleet.run(Seconds(6));
  REQUIRE(three.ant->link_to("bee") != 0);
  for (const std::string other : {"ant", "cloud"}) {
    three.fleet.cut("bee", other);
    three.fleet.cut(other, "bee");
  }
  three.fleet.run(Seconds(9));
  CHECK(three.ant->count("peer_expired") == 0);
  three.fleet.run(milliseconds(4500));
  CHECK(three.ant->count("peer_expired") == 1);
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->state == "OFFLINE");
}

TEST_CASE("of two relays one may go: the other carries on, and no lease runs") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true});
  fleet.start("dock", {.beacon = false, .seeds = {"cloud"}, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud", "dock"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud", "dock"}});
  fleet.run(Seconds(4));
  REQUIRE(Triangle::route(ant, "bee", fleet)->via == "cloud");
  fleet.stop("cloud");
  fleet.run(milliseconds(100));
  CHECK(Triangle::route(ant, "bee", fleet)->via == "dock");
  CHECK(Triangle::route(ant, "bee", fleet)->state == "ONLINE");
  fleet.run(Seconds(12));
  CHECK(Triangle::route(ant, "bee", fleet)->state == "ONLINE");
  CHECK(ant.count("peer_expired") == 1);  // the cloud
}

TEST_CASE("what a relay tells of a node is taken only with a certificate that a Hello could show") {
  Triangle three;
  const auto tell = [&](const TestKeys& keys) {
    const Neighbours told{{{keys.record, 1, "10.0.0.9:1", "1", true, {}}}, {}};
    three.put(three.cloud, "ant", make_message(MessageType::information, "cloud", "ant", told));
  };
  tell(three.fleet.authority.sign_node("eel"));
  CHECK(Triangle::route(*three.ant, "eel", three.fleet)->via == "cloud");

  TestAuthority others;
  tell(others.sign_node("fox"));
  CHECK(three.ant->count("refused.neighbour_foreign_fleet") == 1);
  TestKeys forged = three.fleet.authority.sign_node("fox");
  forged.record.payload.bytes.back() ^= 1;
  tell(forged);
  CHECK(three.ant->count("refused.neighbour_bad_signature") == 1);
  tell(three.fleet.authority.sign_node("bee", Role::robot, 0));
  CHECK(three.ant->count("refused.neighbour_downgraded") == 1);
  CHECK(Triangle::route(*three.ant, "fox", three.fleet) == nullptr);

  RevocationList list{{three.fleet.authority.fleet.id()}, 1, kStartUtc, {{9, "fox", "stolen", kStartUtc}}, 1, {}};
  const SignedRecord record =
      sign(kSignedRevocations, "", three.fleet.authority.fleet.id(), encode(list), three.fleet.authority.key);
  Effects effects;
  REQUIRE(three.ant->core->on_news({record, {}}, 0, three.fleet.now, effects).ok());
  three.fleet.carry_out(*three.ant, effects);
  tell(three.fleet.authority.sign_node("fox"));
  CHECK(three.ant->count("refused.neighbour_cert_revoked") == 1);
  CHECK(Triangle::route(*three.ant, "fox", three.fleet) == nullptr);
}

TEST_CASE("a node that came up without knowing the time talks by the relay all the same") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true});
  fleet.start("ant", {.beacon = false, .seeds = {"cloud"}, .clock_off = -std::chrono::hours(24 * 300)});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(3));
  Triangle::serve(fleet, fleet.at("ant"));
  Triangle::serve(fleet, fleet.at("bee"));
  Triangle::say(fleet, fleet.at("ant"), 1);
  Triangle::say(fleet, fleet.at("bee"), 2, "ant");
  fleet.run(milliseconds(100));
  CHECK(fleet.at("bee").told("numbered") == 1);
  CHECK(fleet.at("ant").told("numbered") == 1);
}

TEST_CASE("what finds the relay's queue full is Nacked to who sent it, once") {
  Triangle three;
  const Relaying relaying = three.wrap(three.numbered("x", MessageType::command));
  Effects effects;
  three.cloud.core->not_passed_on(relaying.message, Errc::queue_full, effects);
  REQUIRE(effects.list.size() == 1);
  const auto& nack = std::get<LinkSend>(effects.list[0]);
  CHECK(nack.link == three.cloud.link_to("ant"));
  CHECK(nack.message.reply_to == 77);
  CHECK(decode<Nack>(nack.message.data)->code == "queue_full");
  Message nonsense = relaying.message;
  nonsense.data = "nothing";
  Effects none;
  three.cloud.core->not_passed_on(nonsense, Errc::queue_full, none);
  CHECK(none.list.empty());
}

TEST_CASE("the same name on another computer counts anew; the old computer's words stay refused") {
  Triangle three;
  three.hand_to_bee(three.signed_by_ant(three.frame(500, three.numbered("old"))));
  CHECK(three.delivered() == 1);
  const SignedRecord kept = three.signed_by_ant(three.frame(501, three.numbered("kept")));
  const TestKeys anew = three.fleet.authority.sign_node("ant", Role::robot, 2);
  const Neighbours told{{{anew.record, 1, "ant", "1", true, {}}}, {}};
  three.put(three.cloud, "bee", make_message(MessageType::information, "cloud", "bee", told));
  three.hand_to_bee(kept);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 1);
  three.hand_to_bee(sign(kSignedRelayed, "ant", three.fleet.authority.fleet.id(),
                         encode(three.frame(1, three.numbered("new"))), anew.identity));
  CHECK(three.delivered() == 2);
}

TEST_CASE("a relay that lies of a node's boot keeps it out of nothing") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(2));
  Neighbours lie;
  lie.reached.push_back({fleet.keys("bee").record, ~std::uint64_t{0}, "", "1", true, {}});
  Effects effects;
  effects.add(LinkSend{cloud.link_to("ant"), make_message(MessageType::information, "cloud", "ant", lie)});
  fleet.carry_out(cloud, effects);
  fleet.run(Seconds(1));
  REQUIRE(ant.peer("bee") != nullptr);
  TestNode& bee = fleet.start("bee", {.seeds = {"ant"}});
  fleet.run(Seconds(4));
  CHECK(bee.link_to("ant") != 0);
  CHECK(ant.count("refused.conflict") == 0);
  CHECK(ant.peer("bee")->boot == 1);
}
