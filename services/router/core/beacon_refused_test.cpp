// Beacons that are refused: replayed, damaged, too many. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("replayed, foreign and damaged beacons are counted and lead nowhere") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(1));
  Effects effects;
  const Bytes first = fleet.at("bee").beacons.front();
  ant.core->beacons().on_beacon(first, fleet.now, effects);
  TestFleet other;
  other.start("cat");
  other.run(milliseconds(100));
  ant.core->beacons().on_beacon(other.at("cat").beacons.front(), fleet.now, effects);
  ant.core->beacons().on_beacon("noise", fleet.now, effects);
  Bytes changed = first;
  changed.back() = static_cast<char>(changed.back() ^ 1);
  ant.core->beacons().on_beacon(changed, fleet.now, effects);
  fleet.carry_out(ant, effects);
  CHECK(ant.count("beacon.replayed") == 1);
  CHECK(ant.count("beacon.foreign_fleet") == 1);
  CHECK(ant.count("beacon.malformed") == 1);
  CHECK(ant.count("beacon.bad_signature") == 1);
  CHECK(ant.core->table().peers().size() == 1);
}

TEST_CASE("a crowd of made-up nodes in beacons gets no row, and no more of this node's time than is set") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  fleet.start("bee");
  fleet.run(Seconds(2));
  const TestAuthority nobody;
  Effects effects;
  for (int i = 0; i < 2'000; ++i) {
    const std::string id = "m" + std::to_string(i);
    const SignedRecord record{std::string(kSignedBeacon),
                              id,
                              {encode(Beacon{nobody.sign_node(id).record, "127.0.0.9:1", 1, 0, 1})},
                              {Bytes(64, 's')}};
    ant.core->beacons().on_beacon(encode(record), fleet.now, effects);
  }
  fleet.carry_out(ant, effects);
  CHECK(ant.count("beacon.foreign_fleet") == kBeaconsChecked);
  CHECK(ant.count("beacon.too_many") == 2'000 - kBeaconsChecked);
  CHECK(ant.core->table().peers().size() == 1);
  CHECK(ant.link_to("bee") != 0);
  fleet.run(Seconds(1));
  fleet.start("cat");
  fleet.run(Seconds(1));
  CHECK(ant.link_to("cat") != 0);
}

TEST_CASE("a beacon of an earlier boot stays a replay while the later one is not linked yet") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  fleet.start("bee", {.boot = 1});
  fleet.run(milliseconds(400));
  const Bytes old = fleet.at("bee").beacons.front();
  fleet.stop("bee");
  fleet.start("bee", {.boot = 2});
  fleet.cut("bee", "ant");
  fleet.run(milliseconds(20));
  Effects effects;
  ant.core->beacons().on_beacon(fleet.at("bee").beacons.front(), fleet.now, effects);
  ant.core->beacons().on_beacon(fleet.at("bee").beacons.front(), fleet.now, effects);
  ant.core->beacons().on_beacon(old, fleet.now, effects);
  fleet.carry_out(ant, effects);
  CHECK(ant.count("beacon.replayed") == 2);
}
