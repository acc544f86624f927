// Beacons by themselves: when this node sends its own, and what a peer's changes.
#include "services/router/core/beacons.hpp"

#include "services/router/test/test_fleet.hpp"
#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Air : Parts {
  Beacons beacons{node, table, trust, links, errors};

  void hear(std::uint64_t boot, std::uint64_t count, const std::string& address = "10.0.0.2:45000",
            Duration clock_off = {}) {
    const Beacon body{bee.record, address, boot, kStartUtc + clock_off.count(), count};
    beacons.on_beacon(encode(sign(kSignedBeacon, "bee", authority.fleet.id(), encode(body), bee.identity)), now, out);
  }
  /// How many beacons it sends in this time.
  std::size_t sent(Duration time) {
    out = {};
    for (Duration passed{}; passed < time; passed += kStep) {
      beacons.tick(now, out);
      pass(kStep);
    }
    return all<SendBeacon>().size();
  }
};

}  // namespace

TEST_CASE("given a start, then three beacons leave within a second, and one each five seconds after them") {
  Air air;
  CHECK(air.sent(std::chrono::seconds(1)) == 0);
  air.beacons.begin(air.now);
  CHECK(air.sent(std::chrono::seconds(1)) == 4);
  CHECK(air.sent(std::chrono::seconds(10)) == 2);
  air.beacons.stop();
  CHECK(air.sent(std::chrono::seconds(10)) == 0);
  CHECK_FALSE(air.beacons.next_deadline());
}

TEST_CASE("given a beacon of an unlinked member with a greater id, then it is dialled at once") {
  Air air;
  air.hear(3, 1);
  const Peer* peer = air.table.find("bee");
  REQUIRE(peer != nullptr);
  CHECK(peer->address == "10.0.0.2:45000");
  CHECK(*peer->redial.at == air.now.mono);
}

TEST_CASE("given a beacon of a new boot, then the link to the process that is gone ends") {
  Air air;
  air.link_with(air.bee);
  air.hear(3, 1);
  CHECK(air.table.link(7) == nullptr);
  CHECK(air.watcher.lost == std::vector<std::string>{"bee"});
}

TEST_CASE("given a beacon that is repeated, then it is refused and changes nothing") {
  Air air;
  air.hear(3, 2);
  air.hear(3, 2, "10.0.0.9:45000");
  CHECK(air.counted("beacon.replayed") == 1);
  CHECK(air.table.find("bee")->address == "10.0.0.2:45000");
}

TEST_CASE("given a peer whose clock is set while it is linked, then its beacons tell of it, and of its end") {
  Air air;
  Link& link = air.link_with(air.bee);
  link.utc_at_zero = 1;
  Peer& bee = *air.table.find("bee");
  bee.boot = 3;
  bee.address = "10.0.0.2:45000";
  const auto codes = [&] {
    std::string all;
    for (const LinkErrorRow& row : air.errors.table("ant", air.now.mono).errors) all += row.peer + ":" + row.code;
    return all;
  };
  air.hear(3, 1, bee.address, std::chrono::hours(1));
  CHECK(codes() == "bee:clock_off");
  air.pass(std::chrono::seconds(5));
  air.hear(3, 2, bee.address);
  CHECK(codes().empty());
  CHECK(air.table.link(7)->utc_at_zero == kStartUtc - air.now.mono.ns);
}
