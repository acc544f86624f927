// Links between nodes: found, dialled, doubled, lost, found again. Time is injected, nothing sleeps.
#include "services/router/test/test_linked.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("two nodes meet by beacon: the smaller id dials, the greater waits") {
  TestFleet fleet;
  fleet.start_two(milliseconds(500));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("ant").dials.size() == 1);
  CHECK(fleet.at("bee").dials.empty());
}

TEST_CASE("two nodes meet by a seed on one side only, whichever side that is") {
  for (const bool smaller_knows : {true, false}) {
    TestFleet fleet;
    fleet.start("ant", {.beacon = false,
                        .seeds = smaller_knows ? std::vector<std::string>{"bee"} : std::vector<std::string>{}});
    fleet.start("bee", {.beacon = false,
                        .seeds = smaller_knows ? std::vector<std::string>{} : std::vector<std::string>{"ant"}});
    fleet.run(Seconds(3));
    check_linked(fleet, "ant", "bee");
  }
}

TEST_CASE("ten nodes that all dial each other at once end with one link a pair, the same on both sides") {
  TestFleet fleet;
  std::vector<std::string> ids;
  for (char c = 'a'; c < 'a' + 10; ++c) ids.push_back(std::string("node-") + c);
  for (const std::string& id : ids) fleet.start(id, {.seeds = ids});
  fleet.run(Seconds(5));
  for (const std::string& a : ids) {
    for (const std::string& b : ids) {
      if (a < b) check_linked(fleet, a, b);
    }
    CHECK(fleet.at(a).core->table().up_links().size() == ids.size() - 1);
  }
  const std::size_t closed = fleet.at("node-a").closed.size();
  fleet.run(Seconds(30));
  CHECK(fleet.at("node-a").closed.size() == closed);
}

TEST_CASE("a seed and a beacon that name one node make one link, not two") {
  TestFleet fleet;
  fleet.start("ant", {.seeds = {"bee", "bee"}});
  fleet.start("bee");
  fleet.run(Seconds(4));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("bee").core->table().up_links().size() == 1);
}

TEST_CASE("a cut, two-way or one-way, ends the lease after ten seconds on both sides") {
  for (const bool one_way : {false, true}) {
    TestFleet fleet;
    fleet.start("ant");
    fleet.start("bee");
    fleet.run(Seconds(1));
    fleet.cut("ant", "bee");
    if (!one_way) fleet.cut("bee", "ant");
    fleet.run(Seconds(7));
    CHECK(fleet.at("ant").link_to("bee") != 0);
    fleet.run(milliseconds(6200));  // what was under way may have renewed the lease once
    for (const char* id : {"ant", "bee"}) {
      const TestNode& node = fleet.at(id);
      CHECK(node.link_to(std::string(id) == "ant" ? "bee" : "ant") == 0);
      CHECK(node.count("peer_expired") == 1);
    }
  }
}

TEST_CASE("whoever takes peer_expired is told of it, and the peer is welcome again afterwards") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  Effects effects;
  ant.core->bus().on_hello(1, {"resilience", {"peer_expired", "peer_joined"}, 5, 100, "1"}, "resilience", fleet.now,
                           effects);
  fleet.carry_out(ant, effects);
  fleet.run(Seconds(1));
  CHECK(ant.told("peer_joined") == 1);
  fleet.stop("bee");
  fleet.run(Seconds(11));
  CHECK(ant.told("peer_expired") == 1);
  CHECK(ant.peer("bee")->expired);
  fleet.start("bee", {.boot = 2});
  fleet.run(Seconds(4));
  check_linked(fleet, "ant", "bee");
  CHECK(ant.told("peer_joined") == 2);
  CHECK_FALSE(ant.peer("bee")->expired);
}

TEST_CASE("a cut of minutes heals: no peer is ever given up") {
  TestFleet fleet;
  fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false});
  fleet.run(Seconds(1));
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.run(Seconds(120));
  CHECK(fleet.at("ant").link_to("bee") == 0);
  fleet.heal();
  fleet.run(Seconds(5));
  check_linked(fleet, "ant", "bee");
}

TEST_CASE(
    "a node that was started again replaces its old link at once; one that lost its count comes back after its end") {
  TestFleet fleet;
  fleet.start("ant", {.boot = 7});
  fleet.start("bee");
  fleet.run(Seconds(1));
  fleet.cut("ant", "bee");  // bee does not learn of the end
  fleet.stop("ant");
  fleet.heal();
  fleet.start("ant", {.boot = 8, .seeds = {"bee"}});
  fleet.run(milliseconds(100));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("bee").peer("ant")->boot == 8);
  fleet.stop("ant");
  fleet.run(Seconds(11));
  fleet.start("ant", {.boot = 6});
  fleet.run(Seconds(5));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("bee").peer("ant")->boot == 6);
  CHECK(fleet.at("bee").count("beacon.replayed") > 0);  // until the link has proven the current boot
}

TEST_CASE("who has stolen the keys and says the highest boot keeps their owner out while it is linked, no longer") {
  TestFleet fleet;
  fleet.start("ant", {.boot = ~std::uint64_t{0}});
  TestNode& bee = fleet.start("bee");
  fleet.run(Seconds(1));
  check_linked(fleet, "ant", "bee");
  const auto hello = [&](LinkId link) {
    const Hello owner{fleet.keys("ant").record, 7, "ant", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects effects;
    bee.core->inbox().on_message(link, fleet.keys("ant").link.public_key,
                                 make_message(MessageType::information, "ant", "", owner), 1, fleet.now, effects);
    fleet.carry_out(bee, effects);
  };
  hello(4711);
  CHECK(bee.count("refused.conflict") == 1);
  CHECK(std::any_of(bee.log.begin(), bee.log.end(),
                    [](const std::string& line) { return line.find("trb fleet revoke") != std::string::npos; }));

  fleet.stop("ant");
  fleet.run(milliseconds(2500));
  fleet.start("ant", {.boot = 7});
  fleet.run(Seconds(12));
  check_linked(fleet, "ant", "bee");
  CHECK(bee.peer("ant")->boot == 7);
}

TEST_CASE("a profile that changes while the Hello is under way, or is too large for one, arrives all the same") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  Effects effects;
  ant.core->bus().on_hello(1, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", fleet.now, effects);
  NodeProfile profile;
  profile.maker = "Maker";
  for (int i = 0; i < 120; ++i)
    profile.skills.push_back({"skill_with_a_long_name_" + std::to_string(i), "grab", {}, true, 2});
  ant.core->forwarding().on_bus_message(1, make_message(MessageType::information, "ant", "ant", profile), fleet.now,
                                        effects);
  fleet.carry_out(ant, effects);
  fleet.run(Seconds(2));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("bee").peer("ant")->profile == profile);
}

TEST_CASE("a Hello read after its dialler gave it up takes nothing: the link that is there stays until a second word") {
  TestFleet fleet;
  fleet.start("ant", {.beacon = false});
  TestNode& bee = fleet.start("bee", {.beacon = false, .seeds = {"ant"}});
  fleet.run(Seconds(2));
  const LinkId live = bee.link_to("ant");
  REQUIRE(live != 0);

  // ant, whose dial would win, has closed the connection long before bee reads its contents.
  const TestKeys& ant = fleet.keys("ant");
  const Hello stale{ant.record, 1, fleet.address("ant"), "1", kStartUtc, true, {}, 0, "behind", false, ""};
  const LinkId late = 4711;
  Effects effects;
  bee.core->inbox().on_message(late, ant.link.public_key, make_message(MessageType::information, "ant", "bee", stale),
                               1, fleet.now, effects);
  fleet.carry_out(bee, effects);
  fleet.run(Seconds(8));
  CHECK(bee.link_to("ant") == live);
  check_linked(fleet, "ant", "bee");
  fleet.run(Seconds(5));
  CHECK(bee.core->table().link(late) == nullptr);  // its lease has ended
  CHECK(bee.link_to("ant") == live);
}

TEST_CASE("the second word on the better link makes it the link") {
  TestFleet fleet;
  fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false, .seeds = {"ant"}});
  fleet.run(Seconds(2));
  check_linked(fleet, "ant", "bee");
  CHECK(fleet.at("ant").core->table().link(fleet.at("ant").link_to("bee"))->dialled);
  CHECK_FALSE(fleet.at("bee").core->table().link(fleet.at("bee").link_to("ant"))->waiting);
}
