// Relays: two members that cannot reach each other talk by a third. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "common/security/relay_box.hpp"
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
      auto relaying = node.core->relay_out(1, to, header_of(message), encode_frame(message), fleet.now_of(node));
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

  /// A command of the scheduler on that node's bus.
  Message command(TestNode& node) const {
    Message message = numbered("x", MessageType::command);
    const auto welcome = std::find_if(node.bus.begin(), node.bus.end(), [](const BusSend& sent) {
      return sent.message.subtype == ServiceWelcome::kSubtype;
    });
    message.id = std::uint64_t{decode<ServiceWelcome>(welcome->message.data)->slot} << 48U | 77;
    return message;
  }
  /// The codes of all that was Nacked to the services of a node.
  static std::vector<std::string> nacks(const TestNode& node) {
    std::vector<std::string> out;
    for (const BusSend& sent : node.bus) {
      if (sent.message.subtype == Nack::kSubtype) out.push_back(decode<Nack>(sent.message.data)->code);
    }
    return out;
  }

  /// What ant's shell would send to the relay.
  Relaying wrap(const Message& message) {
    auto out = ant->core->relay_out(1, "bee", header_of(message), encode_frame(message), fleet.now);
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
  /// As ant would make it; ant's own counts are far below.
  RelayedFrame frame(std::uint64_t count, const Message& inner) const {
    const Bytes key = relay_key(ant->keys.link, bee->keys.link.public_key);
    return {"bee", 1, 1, 1000 + count, fleet.now.utc.ns + 5'000'000'000, {lock_relayed(key, encode_frame(inner))}};
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
  const std::uint64_t before = three.bee->count("relayed.received");
  const Relaying relaying = three.wrap(three.numbered("1"));
  CHECK(relaying.link == three.ant->link_to("cloud"));
  three.put(*three.ant, "cloud", relaying.message);
  three.fleet.run(milliseconds(100));
  CHECK(three.delivered() == 1);
  CHECK(three.bee->bus.back().message.source == "ant");
  CHECK(three.bee->bus.back().message.data == "1");
  CHECK(three.bee->count("relayed.received") == before + 1);
}

TEST_CASE("what is replayed, forged, late or for another boot is refused, each by a name of its own") {
  Triangle three;
  const auto now = three.fleet.now.utc.ns;
  const RelayedFrame good = three.frame(5, three.numbered("x"));
  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.delivered() == 1);

  three.hand_to_bee(three.signed_by_ant(good));
  CHECK(three.bee->count("refused.relayed_replayed") == 1);
  RelayedFrame unproven = three.frame(6, three.numbered("x"));
  unproven.source_boot = 2;
  three.hand_to_bee(three.signed_by_ant(unproven));
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
  garbage.box.bytes = lock_relayed(relay_key(three.ant->keys.link, three.bee->keys.link.public_key), "nothing");
  three.hand_to_bee(three.signed_by_ant(garbage));
  CHECK(three.bee->count("refused.relayed_malformed") == 1);
  RelayedFrame foreign = three.frame(9, three.numbered("x"));
  foreign.box.bytes = lock_relayed(relay_key(three.ant->keys.link, three.cloud.keys.link.public_key), "nothing");
  three.hand_to_bee(three.signed_by_ant(foreign));
  CHECK(three.bee->count("refused.relayed_wrong_key") == 1);
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
  for (const char* word : {"hello", "keep_alive", "goodbye", "relay_refused", "relayed", "neighbours", "execute"}) {
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
  three.fleet.keys("office") = three.fleet.authority.sign_node("office", Role::cloud);
  three.fleet.cut("office", "bee");
  three.fleet.cut("bee", "office");
  TestNode& office = three.fleet.start("office", {.beacon = false, .seeds = {"cloud"}});
  three.fleet.run(Seconds(3));
  REQUIRE(Triangle::route(*three.bee, "office", three.fleet)->via == "cloud");
  Message fault = three.numbered("x");
  fault.source = "office";
  fault.subtype = "robot_fault";
  auto relaying = office.core->relay_out(1, "bee", header_of(fault), encode_frame(fault), three.fleet.now);
  REQUIRE(relaying.ok());
  three.put(office, "cloud", relaying->message);
  three.fleet.run(milliseconds(100));
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

TEST_CASE("a target that the relay has lost: who sent it is told at once; a message over 511 kB never leaves") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  three.fleet.stop("bee");
  three.fleet.run(milliseconds(20));
  Effects effects;
  three.cloud.core->on_link_ended(three.cloud.link_to("bee"), LinkEnd::disconnected, three.fleet.now, effects);
  three.fleet.carry_out(three.cloud, effects);
  three.put(*three.ant, "cloud", relaying.message);
  CHECK(three.cloud.count("dropped.peer_unreachable") == 1);
  three.fleet.run(milliseconds(200));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"peer_unreachable"});
  CHECK(three.ant->peer("bee")->relays.empty());
  const Message later = three.numbered("x");
  const auto gone = three.ant->core->relay_out(1, "bee", header_of(later), encode_frame(later), three.fleet.now);
  CHECK(gone.error().code == Errc::peer_unreachable);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant).size() == 1);

  Triangle again;
  const Message huge = again.numbered(std::string(600'000, 'x'));
  const auto large = again.ant->core->relay_out(1, "bee", header_of(huge), encode_frame(huge), again.fleet.now);
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
  const std::string first = Triangle::route(ant, "bee", fleet)->via;
  const std::string other = first == "cloud" ? "dock" : "cloud";
  REQUIRE(!first.empty());
  fleet.stop(first);
  fleet.run(milliseconds(100));
  CHECK(Triangle::route(ant, "bee", fleet)->via == other);
  CHECK(Triangle::route(ant, "bee", fleet)->state == "ONLINE");
  fleet.run(Seconds(12));
  CHECK(Triangle::route(ant, "bee", fleet)->state == "ONLINE");
  CHECK(ant.count("peer_expired") == 1);  // the relay
}

TEST_CASE("what a relay tells of a node is taken only with a certificate that a Hello could show") {
  Triangle three;
  const auto tell = [&](const TestKeys& keys) {
    const Neighbours told{{keys.record}, {}};
    three.put(three.cloud, "ant", make_message(MessageType::information, "cloud", "ant", told));
  };
  tell(three.fleet.authority.sign_node("eel"));
  CHECK(Triangle::route(*three.ant, "eel", three.fleet)->state == "OFFLINE");

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

TEST_CASE("what finds the relay's queue full, or this node's own, is told to who sent it, once") {
  Triangle three;
  const Relaying relaying = three.wrap(three.command(*three.ant));
  Effects effects;
  three.cloud.core->not_passed_on(relaying.message, Errc::queue_full, effects);
  REQUIRE(effects.list.size() == 1);
  CHECK(std::get<LinkSend>(effects.list[0]).link == three.cloud.link_to("ant"));
  three.fleet.carry_out(three.cloud, effects);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full"});

  const Relaying own = three.wrap(three.command(*three.ant));
  Effects stuck;
  three.ant->core->not_passed_on(own.message, Errc::queue_full, stuck);
  three.fleet.carry_out(*three.ant, stuck);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"queue_full", "queue_full"});

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
  const Neighbours told{{anew.record}, {}};
  three.put(three.cloud, "bee", make_message(MessageType::information, "cloud", "bee", told));
  three.hand_to_bee(kept);
  CHECK(three.bee->count("refused.relayed_bad_signature") == 1);
  RelayedFrame first = three.frame(1, three.numbered("new"));
  first.box.bytes =
      lock_relayed(relay_key(anew.link, three.bee->keys.link.public_key), encode_frame(three.numbered("new")));
  three.hand_to_bee(sign(kSignedRelayed, "ant", three.fleet.authority.fleet.id(), encode(first), anew.identity));
  CHECK(three.bee->count("refused.relayed_replayed") == 1);  // it has not shown that it is there
  CHECK(three.delivered() == 1);
}

TEST_CASE("a relay that says it reaches a node makes it known, and nothing else") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(2));
  for (int i = 0; i < 30; ++i) {
    Effects effects;
    const Neighbours lie{{fleet.keys("bee").record}, {}};
    effects.add(LinkSend{cloud.link_to("ant"), make_message(MessageType::information, "cloud", "ant", lie)});
    fleet.carry_out(cloud, effects);
    fleet.run(Seconds(1));
    CHECK(Triangle::route(ant, "bee", fleet)->state == "OFFLINE");
  }
  CHECK(ant.told("peer_joined") == 0);
  CHECK(ant.peer("bee")->profile == NodeProfile{});
  CHECK(cloud.count("dropped.unknown_target") < 12);  // ever less often

  TestNode& bee = fleet.start("bee", {.seeds = {"ant"}});
  fleet.run(Seconds(4));
  CHECK(bee.link_to("ant") != 0);
  CHECK(ant.peer("bee")->boot == 1);
}

TEST_CASE("a member without the right is no relay, whatever its Hello says") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const TestKeys thief = fleet.keys("thief");
  const auto say = [&](std::uint64_t sequence, const auto& body) {
    Effects effects;
    const Message message = make_message(MessageType::information, "thief", "ant", body);
    ant.core->on_link_message(4711, thief.link.public_key, message, sequence, fleet.now, effects);
    fleet.carry_out(ant, effects);
  };
  say(1, Hello{thief.record, 3, "10.0.0.9:45000", "1", kStartUtc, true, {}, 0, "behind", true, ""});
  REQUIRE(ant.link_to("thief") == 4711);
  say(2, Neighbours{{fleet.keys("bee").record}, {}});
  CHECK(ant.count("refused.not_permitted") == 1);
  CHECK(Triangle::route(ant, "bee", fleet) == nullptr);
  const RelayedFrame frame{"ant", 1, 1, 1, kStartUtc * 2, {"x"}};
  say(3, Relayed{sign(kSignedRelayed, "thief", fleet.authority.fleet.id(), encode(frame), thief.identity)});
  CHECK(ant.count("refused.relayed_no_right") == 1);
}

TEST_CASE("a relay sees from whom and to whom, and nothing of what is said") {
  Triangle three;
  bool seen = false;
  int relayed = 0;
  three.fleet.meddle = [&](const std::string&, LinkId, std::uint64_t&, Message& message) {
    relayed += message.subtype == Relayed::kSubtype ? 1 : 0;
    seen = seen || message.data.find("open the gate") != Bytes::npos || message.data.find("numbered") != Bytes::npos;
    return true;
  };
  three.put(*three.ant, "cloud", three.wrap(three.numbered("open the gate")).message);
  three.fleet.run(milliseconds(100));
  CHECK(three.delivered() == 1);
  CHECK(relayed >= 2);
  CHECK_FALSE(seen);
}

TEST_CASE("a relay that loses a command in silence: who sent it is told that nobody confirms it") {
  Triangle three;
  bool lose = false;
  three.fleet.withhold = [&](const std::string& from, const Message& message) {
    return lose && from == "cloud" && message.subtype == Relayed::kSubtype;
  };
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.run(Seconds(4));
  CHECK(three.nacks(*three.ant).empty());  // it came, and that was confirmed

  lose = true;
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.run(milliseconds(2900));
  CHECK(three.nacks(*three.ant).empty());
  three.fleet.run(milliseconds(200));
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"not_confirmed"});
  three.fleet.run(Seconds(8));
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->state != "ONLINE");
  CHECK(three.nacks(*three.ant).size() == 1);
}

TEST_CASE("a relay that loses one of several is found out at the next word, and another relay is taken") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true});
  fleet.start("dock", {.beacon = false, .seeds = {"cloud"}, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud", "dock"}});
  TestNode& bee = fleet.start("bee", {.beacon = false, .seeds = {"cloud", "dock"}});
  Triangle::serve(fleet, ant);
  Triangle::serve(fleet, bee);
  fleet.run(Seconds(4));
  const std::string first = Triangle::route(ant, "bee", fleet)->via;
  int lose = 1;
  fleet.withhold = [&](const std::string& from, const Message& message) {
    if (from != first || message.subtype != Relayed::kSubtype) return false;
    return decode<Relayed>(message.data)->record.signer == "ant" && lose-- > 0;
  };
  Triangle::say(fleet, ant, 1);
  fleet.run(kStep * 3);
  Triangle::say(fleet, ant, 2);
  fleet.run(milliseconds(400));
  CHECK(ant.told(Nack::kSubtype) == 1);
  CHECK(Triangle::route(ant, "bee", fleet)->via != first);
  Triangle::say(fleet, ant, 3);
  fleet.run(milliseconds(400));
  CHECK(bee.told("numbered") == 2);
  CHECK(ant.told(Nack::kSubtype) == 1);
}

TEST_CASE("a profile goes to who is reached by a relay, by its own word, at once and at each change") {
  Triangle three;
  Effects effects;
  effects.list.clear();
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects said;
    three.ant->core->on_service_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
    three.ant->core->on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile), three.fleet.now,
                                    said);
    three.fleet.carry_out(*three.ant, said);
    three.fleet.run(milliseconds(1200));
  };
  tell("ur3");
  CHECK(three.bee->peer("ant")->profile.model == "ur3");
  tell("ur5");
  CHECK(three.bee->peer("ant")->profile.model == "ur5");
}

TEST_CASE("a word by a relay that names a host instead of numbers is refused, and its sender not dialled there") {
  Triangle three;
  RelayAlive alive;
  alive.address = "hub.example:45000";
  Message word = make_message(MessageType::information, "ant", "bee", alive);
  word.remaining_ms = 5000;
  three.hand_to_bee(three.signed_by_ant(three.frame(1, word)));
  CHECK(three.bee->count("refused.relayed_bad_value") == 1);
  CHECK(three.bee->peer("ant")->address == three.fleet.address("ant"));
}

TEST_CASE("a relay tells of many in several messages, of who has gone too, and nobody of itself") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  std::vector<TestKeys> many;
  const auto come = [&](std::uint64_t number) {
    many.push_back(fleet.authority.sign_node("n" + std::to_string(number)));
    Effects effects;
    const Hello hello{many.back().record, 3, "10.1.0.1:1", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    cloud.core->on_link_message(9000 + number, many.back().link.public_key,
                                make_message(MessageType::information, many.back().certificate.id, "", hello), 1,
                                fleet.now, effects);
    fleet.carry_out(cloud, effects);
  };
  for (std::uint64_t i = 0; i < 65; ++i) come(i);
  fleet.run(milliseconds(300));
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  std::vector<Neighbours> told;
  fleet.meddle = [&](const std::string& from, LinkId, std::uint64_t&, Message& message) {
    if (from == "cloud" && message.subtype == Neighbours::kSubtype) told.push_back(*decode<Neighbours>(message.data));
    return true;
  };
  fleet.run(Seconds(1));
  REQUIRE(cloud.link_to("ant") != 0);
  REQUIRE(told.size() == 2);
  CHECK(told[0].reached.size() == 64);
  CHECK(told[1].reached.size() == 1);
  CHECK(told[0].gone.empty());
  for (const SignedRecord& one : told[0].reached) CHECK(one != ant.keys.record);
  CHECK(ant.peer("n64")->relays == std::set<std::string>{"cloud"});

  // All are told at once of those whose connections end at once.
  told.clear();
  Effects effects;
  for (std::uint64_t i = 0; i < 65; ++i) cloud.core->on_link_ended(9000 + i, LinkEnd::disconnected, fleet.now, effects);
  fleet.carry_out(cloud, effects);
  fleet.run(milliseconds(90));
  CHECK(told.empty());
  fleet.run(milliseconds(60));
  REQUIRE(told.size() == 2);
  CHECK(told[0].gone.size() == 64);
  CHECK(told[1].gone.size() == 1);
  CHECK(told[0].reached.empty());
  CHECK(ant.peer("n64")->relays.empty());
}

TEST_CASE(
    "a target that the relay has never heard of is told from one that it has lost; a stranger's words go nowhere") {
  Triangle three;
  RelayedFrame for_dog = three.frame(30, three.numbered("x"));
  for_dog.target = "dog";
  three.put(*three.ant, "cloud",
            make_message(MessageType::information, "ant", "cloud", Relayed{three.signed_by_ant(for_dog)}));
  CHECK(three.cloud.count("dropped.unknown_target") == 1);
  CHECK(three.ant->count("refused.not_permitted") == 1);  // ant knows no dog either
  CHECK(three.cloud.count("relayed.sent") > 0);

  // What cannot leave is told its signer, if that is there.
  const auto stuck = [&](TestNode& node, const SignedRecord& record) {
    Effects effects;
    node.core->not_passed_on(make_message(MessageType::information, node.id, "bee", Relayed{record}), Errc::queue_full,
                             effects);
    return effects.list.size();
  };
  SignedRecord nobodys = three.signed_by_ant(for_dog);
  nobodys.signer = "nobody";
  CHECK(stuck(three.cloud, nobodys) == 0);
  CHECK(stuck(*three.ant, three.signed_by_ant(for_dog)) == 0);
  CHECK(stuck(three.cloud, three.signed_by_ant(for_dog)) == 1);
  three.fleet.stop("ant");
  Effects ended;
  three.cloud.core->on_link_ended(three.cloud.link_to("ant"), LinkEnd::disconnected, three.fleet.now, ended);
  three.fleet.carry_out(three.cloud, ended);
  CHECK(stuck(three.cloud, nobodys) == 0);
}

TEST_CASE("what a relay says of nodes that nobody knows, or of this one itself, changes nothing") {
  Triangle three;
  const auto tell = [&](const Neighbours& told) {
    three.put(three.cloud, "ant", make_message(MessageType::information, "cloud", "ant", told));
  };
  const std::size_t peers = three.ant->core->peers().size();
  tell({{three.ant->keys.record}, {"nobody", "ant"}});
  CHECK(three.ant->core->peers().size() == peers);
  CHECK(three.ant->peer("ant") == nullptr);
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  tell({{}, {"bee"}});
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->state == "CONNECTION_BROKEN");
  CHECK(std::count(three.ant->log.begin(), three.ant->log.end(), "route_lost bee was reached by cloud") == 1);
}

TEST_CASE("a relay that tells of ever new nodes is listened to for so many signatures in a second") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(2));
  const auto tell = [&](const SignedRecord& record) {
    Effects effects;
    ant.core->on_link_message(ant.link_to("cloud"), cloud.keys.link.public_key,
                              make_message(MessageType::information, "cloud", "ant", Neighbours{{record}, {}}), 1,
                              fleet.now, effects);
    for (const std::string& name : effects.counts) ++ant.counts[name];
  };
  for (std::size_t i = 0; i + 1 < kMaxPeers; ++i) tell(fleet.authority.sign_node("n" + std::to_string(i)).record);
  CHECK(ant.core->peers().size() == kMaxPeers);
  CHECK(ant.count("refused.neighbour_queue_full") == 0);
  const SignedRecord more = fleet.authority.sign_node("one-more").record;
  tell(more);
  CHECK(ant.count("refused.neighbour_queue_full") == 1);
  tell(ant.core->peers().at("n5").certificate_record);  // known: there is room, and no signature to check
  CHECK(ant.count("refused.neighbour_queue_full") == 1);
  for (int i = 0; i < 100; ++i) tell(more);
  CHECK(ant.count("refused.neighbour_too_many") == 100 - 64);
  tell(ant.core->peers().at("n5").certificate_record);
  CHECK(ant.count("refused.neighbour_too_many") == 100 - 64);
  CHECK(cloud.link_to("ant") != 0);
}

TEST_CASE(
    "what leaves by a relay has the time that its sender gave it, by the sender's own clock while that is right") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.start("cloud", {.beacon = false, .relay = true, .clock_off = std::chrono::hours(1)});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(3));
  Message message;
  message.type = MessageType::information;
  message.subtype = "numbered";
  message.source = "ant";
  message.target = "bee";
  message.remaining_ms = 700;
  const auto out = ant.core->relay_out(1, "bee", header_of(message), encode_frame(message), fleet.now);
  REQUIRE(out.ok());
  const auto inner = decode<RelayedFrame>(decode<Relayed>(out->message.data)->record.payload.bytes);
  CHECK(inner->expires == fleet.now.utc.ns + 700'000'000);
  CHECK(out->message.remaining_ms == 700);
}

TEST_CASE(
    "by a relay goes a message of 511 kB, and 256 that wait to hear whether they came; one that does not wait goes") {
  Triangle three;
  const std::size_t most = (1U << 19U) - 1024 - kRelayBoxOverhead;
  const auto out = [&](const Message& message) {
    const auto relaying =
        three.ant->core->relay_out(1, "bee", header_of(message), encode_frame(message), three.fleet.now);
    return relaying ? Errc::ok : relaying.error().code;
  };
  std::string text(most, 'x');
  while (encode_frame(three.numbered(text)).size() > most) text.pop_back();
  REQUIRE(encode_frame(three.numbered(text)).size() == most);
  CHECK(out(three.numbered(text)) == Errc::ok);
  CHECK(out(three.numbered(text + "x")) == Errc::too_large);
  for (std::size_t i = 0; i < RelayRoad::kMaxUnconfirmed - 1; ++i) {
    REQUIRE(out(three.command(*three.ant)) == Errc::ok);
  }
  CHECK(out(three.command(*three.ant)) == Errc::queue_full);
  Message typed = three.numbered("x");
  typed.subtype = RobotFault::kSubtype;
  CHECK(out(typed) == Errc::ok);
  CHECK(three.ant->core->relay_out(1, "nobody", header_of(typed), encode_frame(typed), three.fleet.now).error().code ==
        Errc::peer_unreachable);
}

namespace {

/// ant and bee reach each other by two relays, cloud and dock.
struct TwoRelays {
  TestFleet fleet;
  TestNode* ant = nullptr;
  TestNode* bee = nullptr;
  std::string first;  ///< carries what ant says
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
    fleet.run(Seconds(4));
    first = Triangle::route(*ant, "bee", fleet)->via;
    other = first == "cloud" ? "dock" : "cloud";
    REQUIRE_FALSE(first.empty());
  }
  /// A command that ant has given its relay and the relay has not passed on; its count.
  std::uint64_t lost() {
    Message message;
    message.type = MessageType::command;
    message.subtype = "numbered";
    message.source = "ant";
    message.target = "bee";
    message.id = 5;
    const auto out = ant->core->relay_out(1, "bee", header_of(message), encode_frame(message), fleet.now);
    REQUIRE(out.ok());
    return decode<RelayedFrame>(decode<Relayed>(out->message.data)->record.payload.bytes)->count;
  }
  void refuse(const std::string& relay, const std::string& target, std::uint64_t count, Errc reason) {
    const LinkId link = ant->link_to(relay);
    fleet.arrive(*ant, link, ant->core->find_link(link)->heard + 1,
                 make_message(MessageType::information, relay, "ant",
                              RelayRefused{target, count, std::string(errc_name(reason))}));
  }
  [[nodiscard]] std::string via() const { return Triangle::route(*ant, "bee", fleet)->via; }
};

}  // namespace

TEST_CASE("a relay speaks of what it carries, and of nothing else") {
  TwoRelays two;
  const std::uint64_t count = two.lost();
  two.refuse(two.other, "bee", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 1);
  CHECK(Triangle::nacks(*two.ant).empty());
  two.refuse(two.first, "nobody", count, Errc::peer_unreachable);
  CHECK(two.ant->count("refused.not_permitted") == 2);
  two.refuse(two.first, "bee", count + 1000, Errc::peer_unreachable);  // is not waited for
  CHECK(two.ant->count("refused.not_permitted") == 2);
  CHECK(Triangle::nacks(*two.ant).empty());
  CHECK(two.via() == two.first);
  two.refuse(two.first, "bee", count, Errc::queue_full);
  CHECK(Triangle::nacks(*two.ant) == std::vector<std::string>{"queue_full"});
  CHECK(two.via() == two.first);
  two.refuse(two.first, "bee", two.lost(), Errc::unknown_target);
  CHECK(Triangle::nacks(*two.ant) == std::vector<std::string>{"queue_full", "peer_unreachable"});
  CHECK(two.via() == two.other);
  two.refuse(two.other, "bee", two.lost(), Errc::unknown_target);
  CHECK(two.via() == two.first);  // in turn

  Triangle three;
  const LinkId link = three.cloud.link_to("bee");
  three.fleet.arrive(three.cloud, link, three.cloud.core->find_link(link)->heard + 1,
                     make_message(MessageType::information, "bee", "cloud", RelayRefused{"ant", 1, "queue_full"}));
  CHECK(three.cloud.count("refused.not_permitted") == 1);  // bee is no relay
}

TEST_CASE("when the last relay goes, who waits to hear whether its command came is told at once") {
  Triangle three;
  three.fleet.withhold = [](const std::string& from, const Message& message) {
    return from == "cloud" && message.subtype == Relayed::kSubtype;
  };
  three.put(*three.ant, "cloud", three.wrap(three.command(*three.ant)).message);
  three.fleet.stop("cloud");
  three.fleet.run(2 * kStep);
  Effects effects;
  if (three.ant->link_to("cloud") != 0)
    three.ant->core->on_link_ended(three.ant->link_to("cloud"), LinkEnd::disconnected, three.fleet.now, effects);
  three.fleet.carry_out(*three.ant, effects);
  CHECK(three.nacks(*three.ant) == std::vector<std::string>{"not_confirmed"});
  CHECK(three.ant->count("relayed.unconfirmed") == 1);
  CHECK(std::count_if(three.ant->log.begin(), three.ant->log.end(),
                      [](const std::string& line) { return line.starts_with("route_lost bee"); }) == 1);
}

TEST_CASE("what a node says to every node is taken by a relay too; one whose time or certificate is over is not") {
  Triangle three;
  Message all = three.numbered("to all");
  all.target = "*";
  three.hand_to_bee(three.signed_by_ant(three.frame(40, all)));
  CHECK(three.delivered() == 1);

  const auto hand = [&](const RelayedFrame& frame) {
    const LinkId link = three.bee->link_to("cloud");
    three.fleet.arrive(*three.bee, link, three.bee->core->find_link(link)->heard + 1,
                       make_message(MessageType::information, "cloud", "bee", Relayed{three.signed_by_ant(frame)}));
  };
  RelayedFrame last = three.frame(41, three.numbered("x"));
  last.expires = three.fleet.now.utc.ns;
  hand(last);
  CHECK(three.bee->count("refused.relayed_late") == 1);
  last.expires = three.fleet.now.utc.ns + 1;
  hand(last);
  CHECK(three.delivered() == 2);
  Message spent = three.numbered("x");
  spent.remaining_ms = 0;
  hand(three.frame(42, spent));
  CHECK(three.bee->count("dropped.expired") == 1);

  three.fleet.now.utc = {three.ant->keys.certificate.not_after - 1};
  hand(three.frame(43, three.numbered("x")));
  CHECK(three.delivered() == 3);
  three.fleet.now.utc = {three.ant->keys.certificate.not_after};
  hand(three.frame(44, three.numbered("x")));
  CHECK(three.bee->count("refused.relayed_cert_expired") == 1);
  CHECK(three.delivered() == 3);
}

TEST_CASE("what one relay brings of one node is checked so often in a second and no more") {
  Triangle three;
  SignedRecord forged = three.signed_by_ant(three.frame(50, three.numbered("x")));
  forged.payload.bytes.back() ^= 1;
  const LinkId link = three.bee->link_to("cloud");
  Effects effects;
  for (std::uint32_t i = 0; i < kRelayedChecked + 50; ++i) {
    three.bee->core->on_link_message(link, three.cloud.keys.link.public_key,
                                     make_message(MessageType::information, "cloud", "bee", Relayed{forged}), 1,
                                     three.fleet.now, effects);
  }
  three.fleet.carry_out(*three.bee, effects);
  CHECK(three.bee->count("refused.relayed_too_many") >= 50);
  CHECK(three.bee->count("refused.relayed_too_many") < 60);
  CHECK(three.bee->count("refused.relayed_bad_signature") > kRelayedChecked - 10);
}

TEST_CASE("by a relay a router is asked for its tables, hears who listens, and says when nobody takes a message") {
  Triangle three;
  Effects effects;
  three.bee->core->on_service_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                    effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("robot_fault") == 1);
  CHECK(three.bee->count("dropped.no_service") == 0);  // somebody heard it

  const auto ask = [&](const std::string& word, const Bytes& data, MessageType type) {
    Message question = three.command(*three.ant);
    question.type = type;
    question.subtype = word;
    question.data = data;
    const Routing way = three.ant->core->route_local(1, header_of(question));
    REQUIRE(way.to == Routing::To::relay);
    three.put(*three.ant, "cloud", three.wrap(question).message);
    three.fleet.run(milliseconds(200));
  };
  ask(std::string(RouteListRequest::kSubtype), encode(RouteListRequest{}), MessageType::request);
  CHECK(three.ant->told(RouteTable::kSubtype) == 1);
  ask(std::string(EchoRequest::kSubtype), encode(EchoRequest{{"ping"}}), MessageType::request);
  CHECK(three.ant->told(Echo::kSubtype) == 1);
  ask("unknown_thing", "x", MessageType::command);
  CHECK(three.bee->count("dropped.no_service") == 1);
  CHECK(Triangle::nacks(*three.ant) == std::vector<std::string>{"no_service"});
}

TEST_CASE("of a profile that changes often one is told in a second by a relay, the newest") {
  Triangle three;
  Effects said;
  three.ant->core->on_service_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
  three.fleet.carry_out(*three.ant, said);
  std::size_t sent = 0;
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects effects;
    three.ant->core->on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile), three.fleet.now,
                                    effects);
    three.fleet.carry_out(*three.ant, effects);
    three.fleet.run(5 * kStep);
  };
  tell("a");
  three.fleet.run(Seconds(2));
  REQUIRE(three.bee->peer("ant")->profile.model == "a");
  tell("b");
  CHECK(three.bee->peer("ant")->profile.model == "b");
  for (const char* model : {"c", "d", "e"}) tell(model);
  CHECK(three.bee->peer("ant")->profile.model == "b");
  const std::uint64_t before = three.bee->count("relayed.received");
  three.fleet.run(Seconds(1));
  CHECK(three.bee->peer("ant")->profile.model == "e");
  sent = three.bee->count("relayed.received") - before;
  CHECK(sent == 1);
}

TEST_CASE("who is reached by a relay within the lease has not joined anew; a service hears of one that was gone") {
  Triangle three;
  three.fleet.heal();
  three.fleet.run(Seconds(6));
  REQUIRE(three.ant->link_to("bee") != 0);
  Effects effects;
  three.ant->core->on_service_hello(3, {"resilience", {"peer_joined", "peer_expired"}, 5, 100, "1"}, "resilience",
                                    three.fleet.now, effects);
  three.fleet.carry_out(*three.ant, effects);
  const std::size_t joined = three.ant->told("peer_joined");
  three.fleet.cut("ant", "bee");
  three.fleet.cut("bee", "ant");
  const LinkId link = three.ant->link_to("bee");
  for (TestNode* node : {three.ant, three.bee}) {
    Effects broken;
    node->core->on_link_ended(link, LinkEnd::disconnected, three.fleet.now, broken);
    three.fleet.carry_out(*node, broken);
  }
  three.fleet.run(Seconds(4));
  REQUIRE(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  CHECK(three.ant->told("peer_joined") == joined);
  CHECK(three.ant->told("peer_expired") == 0);
  three.fleet.stop("bee");
  Effects ended;
  three.cloud.core->on_link_ended(three.cloud.link_to("bee"), LinkEnd::disconnected, three.fleet.now, ended);
  three.fleet.carry_out(three.cloud, ended);
  three.fleet.run(Seconds(15));
  CHECK(three.ant->told("peer_expired") == 1);
  three.fleet.start("bee", {.boot = 2, .beacon = false, .seeds = {"cloud"}});
  three.fleet.run(Seconds(4));
  CHECK(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  CHECK(three.ant->told("peer_joined") == joined + 1);
}

TEST_CASE("whose link ends and who is reached by a relay right after, of the same boot, has not joined anew") {
  TestFleet fleet;
  fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  TestNode& bee = fleet.start("bee", {.beacon = false});
  fleet.run(Seconds(1));
  REQUIRE(ant.link_to("bee") != 0);
  fleet.start("dock", {.beacon = false, .seeds = {"ant", "bee"}, .relay = true});
  Effects hello;
  ant.core->on_service_hello(1, {"resilience", {"peer_joined"}, 5, 100, "1"}, "resilience", fleet.now, hello);
  fleet.carry_out(ant, hello);
  fleet.run(Seconds(3));
  const std::size_t joined = ant.told("peer_joined");
  const auto by_relay = [&] {
    return std::count_if(ant.log.begin(), ant.log.end(),
                         [](const std::string& line) { return line.starts_with("peer_joined bee by way of dock"); });
  };
  REQUIRE(by_relay() == 0);
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  const LinkId link = ant.link_to("bee");
  for (TestNode* node : {&ant, &bee}) {
    Effects broken;
    node->core->on_link_ended(link, LinkEnd::disconnected, fleet.now, broken);
    fleet.carry_out(*node, broken);
  }
  fleet.run(Seconds(4));
  CHECK(by_relay() == 1);
  CHECK(ant.told("peer_joined") == joined);
}

TEST_CASE("a word by a relay that one service takes and another hears comes to both") {
  Triangle three;
  Effects effects;
  three.bee->core->on_service_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                    effects);
  three.bee->core->on_service_hello(4, {"cloud-gateway", {"robot_fault"}, 6, 100, "1"}, "cloud-gateway",
                                    three.fleet.now, effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  std::string heard;
  for (const BusSend& send : three.bee->bus) {
    if (send.message.subtype == RobotFault::kSubtype) heard += std::to_string(send.to) + " ";
  }
  CHECK(heard == "3 4 ");
}
