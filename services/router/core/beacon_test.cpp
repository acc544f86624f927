// What a beacon of a known peer changes: nothing, or its address.
#include <doctest/doctest.h>

#include "services/router/test/test_inbox.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a beacon that was heard before a link stays a replay after it") {
  Inbox inbox;
  const Beacon body{inbox.bee.record, "10.0.0.2:45000", 3, kStartUtc, 1};
  const Bytes beacon =
      encode(sign(kSignedBeacon, "bee", inbox.fleet.authority.fleet.id(), encode(body), inbox.bee.identity));
  Effects effects;
  inbox.ant.core->beacons().on_beacon(beacon, inbox.fleet.now, effects);
  inbox.say_hello(9, inbox.bee);  // of the same boot
  REQUIRE(inbox.ant.link_to("bee") == 9);
  inbox.ant.core->beacons().on_beacon(beacon, inbox.fleet.now, effects);
  inbox.fleet.carry_out(inbox.ant, effects);
  CHECK(inbox.ant.count("beacon.replayed") == 1);
}

TEST_CASE("a beacon that tells nothing new of a linked peer costs no signature, and changes nothing, signed or not") {
  Inbox inbox;
  inbox.say_hello(9, inbox.bee);
  Effects effects;
  const auto hear = [&](std::uint64_t boot, std::uint64_t count, bool is_signed) {
    const Beacon body{inbox.bee.record, "10.0.0.2:45000", boot, kStartUtc, count};
    SignedRecord record =
        sign(kSignedBeacon, "bee", inbox.fleet.authority.fleet.id(), encode(body), inbox.bee.identity);
    if (!is_signed) record.signature.bytes = Bytes(64, 's');
    inbox.ant.core->beacons().on_beacon(encode(record), inbox.fleet.now, effects);
    inbox.fleet.carry_out(inbox.ant, effects);
    effects = {};
    return inbox.ant.count("beacon.bad_signature");
  };
  CHECK(hear(3, 1, true) == 0);  // the first of this boot is checked
  CHECK(hear(3, 900, false) == 0);
  CHECK(inbox.ant.peer("bee")->beacon_count == 1);
  CHECK(hear(4, 901, false) == 1);  // it would cut the link
  inbox.fleet.now.mono = inbox.fleet.now.mono + Seconds(2);
  CHECK(hear(3, 902, false) == 2);  // it would be a sign of life
  CHECK(hear(3, 2, true) == 2);
  CHECK(inbox.ant.peer("bee")->beacon_count == 2);
  CHECK(inbox.ant.link_to("bee") == 9);
}

TEST_CASE("a linked peer that tells by a beacon of a new start, or of another place, is cut and dialled there") {
  for (const bool again : {true, false}) {
    CAPTURE(again);
    Inbox inbox;
    inbox.say_hello(9, inbox.bee);
    const Beacon body{inbox.bee.record, again ? "10.0.0.2:45000" : "10.0.0.3:45000", again ? 4U : 3U, kStartUtc, 1};
    Effects effects;
    inbox.ant.core->beacons().on_beacon(
        encode(sign(kSignedBeacon, "bee", inbox.fleet.authority.fleet.id(), encode(body), inbox.bee.identity)),
        inbox.fleet.now, effects);
    inbox.fleet.carry_out(inbox.ant, effects);
    CHECK(inbox.ant.link_to("bee") == 0);
    CHECK(inbox.ant.closed == std::vector<LinkId>{9});
    CHECK(inbox.ant.log.back() ==
          std::string("link_closed bee: ") + (again ? "its node was started again" : "its address has changed"));
    inbox.fleet.run(kStep);
    REQUIRE(inbox.ant.dials.size() == 1);
    CHECK(inbox.ant.dials[0].address == body.address);
  }
}

TEST_CASE("another key under a name, the node's or its link's, is another computer: its beacons count anew") {
  for (const bool identity : {true, false}) {
    CAPTURE(identity);
    Inbox inbox;
    const auto beacon = [&](const TestKeys& keys, std::uint64_t count) {
      const Beacon body{keys.record, "10.0.0.2:45000", 3, kStartUtc, count};
      Effects effects;
      inbox.ant.core->beacons().on_beacon(
          encode(sign(kSignedBeacon, "bee", inbox.fleet.authority.fleet.id(), encode(body), keys.identity)),
          inbox.fleet.now, effects);
      inbox.fleet.carry_out(inbox.ant, effects);
    };
    beacon(inbox.bee, 9);
    TestKeys fresh = inbox.fleet.authority.sign_node("bee", Role::robot, 2);
    if (identity) {
      fresh.link = inbox.bee.link;
      fresh.certificate.link_key = inbox.bee.certificate.link_key;
    } else {
      fresh.identity = inbox.bee.identity;
      fresh.certificate.identity_key = inbox.bee.certificate.identity_key;
    }
    fresh.record = sign(kSignedCertificate, "", inbox.fleet.authority.fleet.id(), encode(fresh.certificate),
                        inbox.fleet.authority.key);
    inbox.say_hello(9, fresh);
    REQUIRE(inbox.ant.link_to("bee") == 9);
    beacon(fresh, 1);
    CHECK(inbox.ant.count("beacon.replayed") == 0);
    CHECK(inbox.ant.link_to("bee") == 9);
  }
}
