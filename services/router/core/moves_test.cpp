// Addresses that change, and whom a node lets in and dials without having met them. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/core/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;

namespace {

void check_linked(TestFleet& fleet, const std::string& a, const std::string& b) {
  CAPTURE(a);
  CAPTURE(b);
  CHECK(fleet.at(a).link_to(b) != 0);
  CHECK(fleet.at(a).link_to(b) == fleet.at(b).link_to(a));
}

}  // namespace

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
      fleet.move(mover, "elsewhere");
      fleet.run(milliseconds(500));
      check_linked(fleet, "ant", "bee");
      CHECK(fleet.at(other).link_to(mover) != before);
      CHECK(fleet.at(other).peer(mover)->address == "elsewhere");
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
  fleet.start("ant");
  fleet.start("bee");
  fleet.run(Seconds(1));
  const LinkId link = fleet.at("ant").link_to("bee");
  fleet.run(Seconds(60));
  CHECK(fleet.at("bee").beacons.size() > 10);
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
  CHECK(ant.core->route_table(fleet.now).routes.at(0).address.empty());
  fleet.start("bee");
  fleet.move("ant", "ant");
  fleet.run(Seconds(2));
  CHECK_FALSE(ant.beacons.empty());
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("a seed that was never met is let in whatever the crowd of strangers") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  Effects effects;
  for (int i = 0; i < 40; ++i) ant.core->admit(make_link_key().public_key, fleet.now.mono, effects);
  CHECK_FALSE(ant.core->admit(fleet.keys("cat").link.public_key, fleet.now.mono, effects));
  CHECK(ant.core->admit(fleet.keys("bee").link.public_key, fleet.now.mono, effects));
}

TEST_CASE("the peers of the last run are dialled at the start, and gathered for the next") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false});
  fleet.run(Seconds(10));
  CHECK(ant.stored.starts_with("bee "));
  CHECK(std::count(ant.stored.begin(), ant.stored.end(), '\n') == 1);
  fleet.stop("ant");
  fleet.stop("bee");
  fleet.start("bee", {.boot = 2, .beacon = false});
  fleet.start("ant", {.boot = 2, .beacon = false, .known = {"bee"}});
  fleet.run(Seconds(1));
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
