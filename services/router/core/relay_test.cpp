// Which nodes relay, whom they reach, and which of their claims are believed. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;

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

TEST_CASE("who falls silent behind a relay was last heard when it said its last word") {
  Triangle three;
  three.fleet.run(Seconds(20));
  three.fleet.meddle = [](const std::string& from, LinkId, std::uint64_t&, Message&) { return from != "bee"; };
  three.fleet.run(Seconds(11));
  const Route* bee = Triangle::route(*three.ant, "bee", three.fleet);
  CHECK(bee->state == "OFFLINE");
  CHECK(bee->last_heard_s > 9);
  CHECK(bee->last_heard_s < 14);
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
  TwoRelays two;
  const auto state = [&] { return Triangle::route(*two.ant, "bee", two.fleet)->state; };
  two.fleet.stop(two.first);
  two.fleet.run(milliseconds(100));
  CHECK(two.via() == two.other);
  CHECK(state() == "ONLINE");
  two.fleet.run(Seconds(12));
  CHECK(state() == "ONLINE");
  CHECK(two.ant->count("peer_expired") == 1);  // the relay
}

TEST_CASE("what a relay tells of a node is taken only with a certificate that a Hello could show") {
  Triangle three;
  const auto tell = [&](const TestKeys& keys) {
    const ReachablePeerList told{{keys.record}, {}};
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
  REQUIRE(three.ant->core->updates().on_update({record, {}}, 0, three.fleet.now, effects).ok());
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

TEST_CASE("a relay that is away for less than a lease carries messages again once it is back") {
  Triangle three;
  three.fleet.stop("cloud");
  three.fleet.run(Seconds(6));
  TestNode& cloud = three.fleet.start("cloud", {.boot = 2, .beacon = false, .relay = true});
  three.fleet.run(Seconds(4));
  REQUIRE(cloud.link_to("bee") != 0);
  Triangle::say(three.fleet, *three.ant, 1);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("numbered") == 1);
}

TEST_CASE("a right to relay that a renewal withdraws or grants is in force at once: links are made anew with it") {
  Triangle three;
  const auto renew = [&](TestNode& told, std::uint64_t serial, bool relay) {
    Certificate certificate = three.fleet.keys("cloud").certificate;
    certificate.serial = serial;
    certificate.relay = relay;
    const TestAuthority& authority = three.fleet.authority;
    Effects effects;
    const TrustUpdate update{{},
                             {sign(kSignedCertificate, "", authority.fleet.id(), encode(certificate), authority.key)}};
    REQUIRE(told.core->updates().on_update(update, 0, three.fleet.now, effects).ok());
    three.fleet.carry_out(told, effects);
    three.fleet.run(Seconds(4));
    CHECK(three.cloud.core->config().own.relay == relay);
    CHECK(three.ant->link_to("cloud") != 0);
    CHECK(three.bee->link_to("cloud") != 0);
  };
  renew(*three.ant, 5, false);
  Triangle::say(three.fleet, *three.ant, 1);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("numbered") == 0);
  CHECK(three.ant->count("refused.not_permitted") == 0);

  const LinkId before = three.ant->link_to("cloud");
  renew(three.cloud, 6, true);
  CHECK(three.ant->link_to("cloud") != before);
  CHECK(three.ant->count("refused.not_permitted") == 0);
  Triangle::say(three.fleet, *three.ant, 2);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("numbered") == 1);
  const LinkId now = three.ant->link_to("cloud");
  renew(three.cloud, 7, true);
  CHECK(three.ant->link_to("cloud") == now);
}

TEST_CASE("a relay that says it reaches a node makes it known, and nothing else") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(2));
  for (int i = 0; i < 30; ++i) {
    Effects effects;
    const ReachablePeerList lie{{fleet.keys("bee").record}, {}};
    effects.add(LinkSend{cloud.link_to("ant"), make_message(MessageType::information, "cloud", "ant", lie)});
    fleet.carry_out(cloud, effects);
    fleet.run(Seconds(1));
    CHECK(Triangle::route(ant, "bee", fleet)->state == "OFFLINE");
  }
  CHECK(ant.told("peer_joined") == 0);
  CHECK(ant.peer("bee")->profile == NodeProfile{});
  CHECK(cloud.count("dropped.unknown_target") < 12);  // less and less often

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
    ant.core->inbox().on_message(4711, thief.link.public_key, message, sequence, fleet.now, effects);
    fleet.carry_out(ant, effects);
  };
  say(1, Hello{thief.record, 3, "10.0.0.9:45000", "1", kStartUtc, true, {}, 0, "behind", true, ""});
  REQUIRE(ant.link_to("thief") == 4711);
  say(2, ReachablePeerList{{fleet.keys("bee").record}, {}});
  CHECK(ant.count("refused.not_permitted") == 1);
  CHECK(Triangle::route(ant, "bee", fleet) == nullptr);
  const RelayedFrame frame{"ant", 1, 1, 1, kStartUtc * 2, {"x"}};
  say(3, Relayed{sign(kSignedRelayed, "thief", fleet.authority.fleet.id(), encode(frame), thief.identity)});
  CHECK(ant.count("refused.relayed_no_right") == 1);
}

TEST_CASE("a relay tells of many in several messages, of who has gone too, and nobody of itself") {
  TestFleet fleet;
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  std::vector<TestKeys> many;
  const auto come = [&](std::uint64_t number) {
    many.push_back(fleet.authority.sign_node("n" + std::to_string(number)));
    Effects effects;
    const Hello hello{many.back().record, 3, "10.1.0.1:1", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    cloud.core->inbox().on_message(9000 + number, many.back().link.public_key,
                                   make_message(MessageType::information, many.back().certificate.id, "", hello), 1,
                                   fleet.now, effects);
    fleet.carry_out(cloud, effects);
  };
  for (std::uint64_t i = 0; i < 65; ++i) come(i);
  fleet.run(milliseconds(300));
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  std::vector<ReachablePeerList> told;
  fleet.meddle = [&](const std::string& from, LinkId, std::uint64_t&, Message& message) {
    if (from == "cloud" && message.subtype == ReachablePeerList::kSubtype)
      told.push_back(*decode<ReachablePeerList>(message.data));
    return true;
  };
  fleet.run(Seconds(1));
  REQUIRE(cloud.link_to("ant") != 0);
  REQUIRE(told.size() == 2);
  CHECK(told[0].reached.size() == 64);
  CHECK(told[1].reached.size() == 1);
  CHECK(told[0].gone.empty());
  for (const SignedRecord& one : told[0].reached) CHECK(one != ant.keys.record);
  CHECK(ant.relay_route("n64").relays == std::set<std::string>{"cloud"});

  // Peers whose connections end at once are reported at once.
  told.clear();
  Effects effects;
  for (std::uint64_t i = 0; i < 65; ++i)
    cloud.core->links().on_ended(9000 + i, LinkEndReason::disconnected, fleet.now, effects);
  fleet.carry_out(cloud, effects);
  fleet.run(milliseconds(90));
  CHECK(told.empty());
  fleet.run(milliseconds(60));
  REQUIRE(told.size() == 2);
  CHECK(told[0].gone.size() == 64);
  CHECK(told[1].gone.size() == 1);
  CHECK(told[0].reached.empty());
  CHECK(ant.relay_route("n64").relays.empty());
}

TEST_CASE("what a relay says of nodes that nobody knows, or of this one itself, changes nothing") {
  Triangle three;
  const auto tell = [&](const ReachablePeerList& told) {
    three.put(three.cloud, "ant", make_message(MessageType::information, "cloud", "ant", told));
  };
  const std::size_t peers = three.ant->core->table().peers().size();
  tell({{three.ant->keys.record}, {"nobody", "ant"}});
  CHECK(three.ant->core->table().peers().size() == peers);
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
    ant.core->inbox().on_message(
        ant.link_to("cloud"), cloud.keys.link.public_key,
        make_message(MessageType::information, "cloud", "ant", ReachablePeerList{{record}, {}}), 1, fleet.now, effects);
    for (const std::string& name : effects.counts) ant.core->counters().count(name);
  };
  for (std::size_t i = 0; i + 1 < kMaxPeers; ++i) tell(fleet.authority.sign_node("n" + std::to_string(i)).record);
  CHECK(ant.core->table().peers().size() == kMaxPeers);
  CHECK(ant.count("refused.neighbour_queue_full") == 0);
  const SignedRecord more = fleet.authority.sign_node("one-more").record;
  tell(more);
  CHECK(ant.count("refused.neighbour_queue_full") == 1);
  tell(ant.core->table().peers().at("n5").certificate_record);  // known: there is room, and no signature to check
  CHECK(ant.count("refused.neighbour_queue_full") == 1);
  for (int i = 0; i < 100; ++i) tell(more);
  CHECK(ant.count("refused.neighbour_too_many") == 100 - 64);
  tell(ant.core->table().peers().at("n5").certificate_record);
  CHECK(ant.count("refused.neighbour_too_many") == 100 - 64);
  CHECK(cloud.link_to("ant") != 0);
}

TEST_CASE("who is reached by a relay within the lease has not joined anew; a service hears of one that was gone") {
  Triangle three;
  three.fleet.heal();
  three.fleet.run(Seconds(6));
  REQUIRE(three.ant->link_to("bee") != 0);
  Effects effects;
  three.ant->core->bus().on_hello(3, {"resilience", {"peer_joined", "peer_expired"}, 5, 100, "1"}, "resilience",
                                  three.fleet.now, effects);
  three.fleet.carry_out(*three.ant, effects);
  const std::size_t joined = three.ant->told("peer_joined");
  three.fleet.cut("ant", "bee");
  three.fleet.cut("bee", "ant");
  const LinkId link = three.ant->link_to("bee");
  for (TestNode* node : {three.ant, three.bee}) {
    Effects broken;
    node->core->links().on_ended(link, LinkEndReason::disconnected, three.fleet.now, broken);
    three.fleet.carry_out(*node, broken);
  }
  three.fleet.run(Seconds(4));
  REQUIRE(Triangle::route(*three.ant, "bee", three.fleet)->via == "cloud");
  CHECK(three.ant->told("peer_joined") == joined);
  CHECK(three.ant->told("peer_expired") == 0);
  three.fleet.stop("bee");
  Effects ended;
  three.cloud.core->links().on_ended(three.cloud.link_to("bee"), LinkEndReason::disconnected, three.fleet.now, ended);
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
  ant.core->bus().on_hello(1, {"resilience", {"peer_joined"}, 5, 100, "1"}, "resilience", fleet.now, hello);
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
    node->core->links().on_ended(link, LinkEndReason::disconnected, fleet.now, broken);
    fleet.carry_out(*node, broken);
  }
  fleet.run(Seconds(4));
  CHECK(by_relay() == 1);
  CHECK(ant.told("peer_joined") == joined);
}
