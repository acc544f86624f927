// Changing addresses, and whom a node lets in and dials before they have met. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/name_dial.hpp"
#include "services/router/test/test_fleet.hpp"
#include "services/router/test/test_linked.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE(
    "a node whose address changes is linked again at once, whichever id it has, with beacons or by its own dial") {
  for (const char* mover : {"ant", "bee"}) {
    for (const bool beacon : {true, false}) {
      CAPTURE(mover);
      CAPTURE(beacon);
      TestFleet fleet;
      fleet.start("ant", {.beacon = beacon, .seeds = {"bee"}});
      fleet.start("bee", {.beacon = beacon});
      fleet.run(Seconds(4));
      check_linked(fleet, "ant", "bee");
      const std::string other = std::string(mover) == "ant" ? "bee" : "ant";
      const LinkId before = fleet.at(other).link_to(mover);
      fleet.move(mover, "10.0.1.1:45000");
      fleet.run(milliseconds(500));
      check_linked(fleet, "ant", "bee");
      CHECK(fleet.at(other).link_to(mover) != before);
      CHECK(fleet.at(other).peer(mover)->address == "10.0.1.1:45000");
      const std::size_t closed = fleet.at("ant").closed.size() + fleet.at("bee").closed.size();
      fleet.run(Seconds(30));
      CHECK(fleet.at("ant").closed.size() + fleet.at("bee").closed.size() == closed);
      CHECK(fleet.at(other).count("peer_expired") == 0);
    }
  }
}

TEST_CASE("both sides let the link of a new address win, whoever dialled it") {
  Link old_link;
  old_link.own_address = "here";
  old_link.peer_address = "there";
  Link new_link = old_link;
  for (const bool smaller : {true, false}) {
    old_link.dialled = smaller;
    new_link.dialled = !smaller;
    new_link.peer_address = "there";
    CHECK_FALSE(new_link_wins(old_link, new_link, smaller));
    new_link.peer_address = "elsewhere";
    CHECK(new_link_wins(old_link, new_link, smaller));
  }
}

TEST_CASE("a beacon about a linked peer at the same address changes nothing") {
  TestFleet fleet;
  fleet.start_two(Seconds(1));
  const LinkId link = fleet.at("ant").link_to("bee");
  fleet.run(Seconds(60));
  CHECK(fleet.at("bee").beacons.size() > 10);
  CHECK(fleet.at("bee").beacons.size() < 20);  // a few at its start, then one every five seconds
  CHECK(fleet.at("bee").count("sent.beacon") == fleet.at("bee").beacons.size());
  CHECK(fleet.at("ant").link_to("bee") == link);
  CHECK(fleet.at("ant").dials.size() == 1);
}

TEST_CASE("a node without an address dials by its seeds, sends no beacon, and says what it waits for") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  Effects effects;
  ant.core->set_address("", "HOST_INT: there is no interface 'tun0'", fleet.now, effects);
  fleet.carry_out(ant, effects);
  fleet.run(Seconds(30));
  CHECK(ant.beacons.empty());
  CHECK(ant.core->answers().route_table(fleet.now).routes.at(0).address.empty());
  fleet.start("bee");
  fleet.move("ant", fleet.address("ant"));
  fleet.run(Seconds(2));
  CHECK_FALSE(ant.beacons.empty());
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("a seed that was never met is let in whatever the crowd of strangers") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  Effects effects;
  for (int i = 0; i < 40; ++i) ant.core->admission().admit(make_link_key().public_key, fleet.now, effects);
  CHECK_FALSE(ant.core->admission().admit(fleet.keys("cat").link.public_key, fleet.now, effects));
  CHECK(ant.core->admission().admit(fleet.keys("bee").link.public_key, fleet.now, effects));
}

TEST_CASE("the peers of the last run are dialled at the start, and gathered for the next") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false});
  fleet.run(Seconds(10));
  CHECK(ant.stored.starts_with(fleet.address("bee") + " "));
  CHECK(std::count(ant.stored.begin(), ant.stored.end(), '\n') == 1);
  fleet.stop("ant");
  fleet.stop("bee");
  fleet.start("bee", {.boot = 2, .beacon = false});
  fleet.start("ant", {.boot = 2, .beacon = false, .known = {"bee"}});
  fleet.run(Seconds(1));
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("given a hint whose peer is met, then it is gone, and the peer is dialled again at its own address") {
  TestFleet fleet;
  fleet.start("bee", {.beacon = false});
  TestNode& ant = fleet.start("ant", {.beacon = false, .known = {"bee", "cat"}});
  CHECK(std::as_const(*ant.core).table().seeds().size() == 2);
  fleet.run(Seconds(1));
  check_linked(fleet, "ant", "bee");
  const auto& seeds = std::as_const(*ant.core).table().seeds();
  REQUIRE(seeds.size() == 1);
  CHECK(seeds[0].key == fleet.keys("cat").link.public_key);
  fleet.stop("bee");
  fleet.run(Seconds(1));
  fleet.start("bee", {.boot = 2, .beacon = false});
  fleet.run(Seconds(5));
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("a hint that leads nowhere is dialled ever more seldom") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .known = {"bee"}});
  fleet.run(Seconds(20));
  const std::size_t early = ant.dials.size();
  fleet.run(Seconds(120));
  CHECK(early >= 4);
  CHECK(ant.dials.size() - early <= 5);
}

TEST_CASE("a Hello and a beacon that name a host instead of numbers are refused, and never dialled") {
  const std::vector<std::string> names = {"hub.example:45000", "localhost:45000",     "10.0.0.9",
                                          "10.0.0.9:0",        "10.0.0.9:70000",      "010.0.0.9:45000",
                                          "[fe80::1%a b]:1",   "[fd00::1:45000",      "fd00::1:45000",
                                          "0x0a000001:45000",  "10.0.0.9:45000\nx:1", "[::1]@hub:45000"};
  for (const std::string& name : names) {
    CAPTURE(name);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    const TestKeys cat = fleet.keys("cat");
    Effects effects;
    const auto greet = [&](const std::string& id, const std::string& address, const std::string& lane) {
      const TestKeys keys = fleet.keys(id);
      const Hello hello{keys.record, 3, address, "1", kStartUtc, true, {}, 0, "behind", false, lane};
      ant.core->inbox().on_message(random_u64(), keys.link.public_key,
                                   make_message(MessageType::information, id, "", hello), 1, fleet.now, effects);
    };
    greet("bee", name, "");
    greet("dog", "", name);
    const Beacon beacon{cat.record, name, 1, kStartUtc, 1};
    const SignedRecord record =
        sign(kSignedBeacon, "cat", fleet.authority.fleet.id(), encode(beacon), fleet.keys("cat").identity);
    ant.core->beacons().on_beacon(encode(record), fleet.now, effects);
    fleet.carry_out(ant, effects);
    fleet.run(Seconds(10));
    CHECK(ant.count("refused.bad_value") == 2);
    CHECK(ant.count("beacon.bad_value") == 1);
    for (const char* id : {"bee", "cat", "dog"}) CHECK(ant.peer(id) == nullptr);
    CHECK(ant.dials.empty());
    CHECK(ant.log.end() != std::find_if(ant.log.begin(), ant.log.end(), [](const std::string& line) {
            return line.find("lane of 'dog' is no IPv4 or IPv6 address with a port") != std::string::npos;
          }));
  }
}

TEST_CASE("a Hello with an IPv6 address, or without one, is taken") {
  for (const std::string address : {"[fd00::1]:45000", "[fe80::1%eth0]:45000", ""}) {
    CAPTURE(address);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    const TestKeys bee = fleet.keys("bee");
    const Hello hello{bee.record, 3, address, "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects effects;
    ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "", hello), 1,
                                 fleet.now, effects);
    fleet.carry_out(ant, effects);
    CHECK(ant.link_to("bee") == 9);
  }
}

TEST_CASE("a peer that tells no address is not dialled when its link has ended, until it tells one") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const TestKeys bee = fleet.keys("bee");
  const Hello hello{bee.record, 3, "", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  Effects effects;
  ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "", hello), 1,
                               fleet.now, effects);
  fleet.carry_out(ant, effects);
  REQUIRE(ant.link_to("bee") == 9);
  Effects ended;
  ant.core->links().on_ended(9, LinkEndReason::disconnected, fleet.now, ended);
  fleet.carry_out(ant, ended);
  fleet.run(Seconds(30));
  CHECK(ant.dials.empty());
  fleet.start("bee", {.boot = 4});
  fleet.run(Seconds(3));
  CHECK_FALSE(ant.dials.empty());
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("a seed may be a host's name: what it was found to be is known as its address, and stored; a name never is") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  TestNode& bee = fleet.start("bee", {.beacon = false, .seed_names = {{"ant", "hub.example:45000"}}});
  fleet.run(Seconds(3));
  CHECK(bee.link_to("ant") == 0);
  CHECK(bee.count("dial.no_name") >= 3);
  const auto asked = [&](std::string_view word) {
    return std::any_of(bee.log.begin(), bee.log.end(),
                       [&](const std::string& line) { return line.find(word) != std::string::npos; });
  };
  CHECK(asked("dial_ended unproven: the name server has not answered for hub.example:45000 yet"));
  fleet.hosts["hub.example:45000"] = fleet.address("ant");
  fleet.run(Seconds(10));
  check_linked(fleet, "ant", "bee");
  CHECK(bee.peer("ant")->good_address == fleet.address("ant"));
  CHECK(bee.lane_dials.at(0).address == "10.0.0.1:45001");
  CHECK(bee.stored.starts_with(fleet.address("ant") + " "));
  CHECK(ant.link_to("bee") != 0);
}

TEST_CASE("a name among the peers of the last run, as an earlier release stored it, is left out") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .known_names = {{"bee", "hub.example:45000"}}});
  fleet.run(Seconds(30));
  CHECK(ant.dials.empty());
  CHECK(ant.count("dial.no_name") == 0);
}

TEST_CASE("a dial to where a peer no longer is ends when its beacon tells another address") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const TestKeys bee = fleet.keys("bee");
  const auto hear = [&](const std::string& address, std::uint64_t count) {
    const Beacon beacon{bee.record, address, 1, kStartUtc, count};
    Effects effects;
    ant.core->beacons().on_beacon(
        encode(sign(kSignedBeacon, "bee", fleet.authority.fleet.id(), encode(beacon), bee.identity)), fleet.now,
        effects);
    ant.core->tick(fleet.now, effects);
    return effects;
  };
  const auto dial_of = [](const Effects& effects) {
    for (const Effect& effect : effects.list) {
      if (const auto* dial = std::get_if<Dial>(&effect)) return *dial;
    }
    return Dial{};
  };
  const Dial first = dial_of(hear("10.0.0.2:45000", 1));
  CHECK(first.address == "10.0.0.2:45000");
  const Effects moved = hear("10.0.0.3:45000", 2);
  CHECK(ant.core->table().link(first.link) == nullptr);
  CHECK(dial_of(moved).address == "10.0.0.3:45000");
}

TEST_CASE("a dial whose name is not known ends at once, and one that is over is not counted") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  NameDial of(fleet, ant.core->config(), fleet.keys("bee").link.public_key);
  RouterCore& core = of.core;
  const LinkId link = of.link;
  Effects out;
  core.links().on_name_unknown(link, "no such name", fleet.now, out);
  core.links().on_name_unknown(link, "no such name", fleet.now, out);
  CHECK(core.table().link(link) == nullptr);
  CHECK(out.counts == std::vector<std::string>{"dial.no_name"});
}
