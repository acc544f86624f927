// The lower bound of the time: raised only by a clock that can be trusted. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include <limits>

#include "services/router/core/clock_bound.hpp"
#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;
using std::chrono::minutes;

namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();

/// A clock of UTC beside the monotonic one, and what would have been written to state/utc.
struct Fixture {
  ClockBound clock;
  Now now{{1'000'000'000}, {kStartUtc}};
  std::vector<std::int64_t> peers;
  std::vector<UtcTime> stored;

  Fixture() { clock.start({}, now); }
  void run(Duration time) {
    for (Duration left = time; left > Duration{}; left -= Seconds(2)) {
      now = {now.mono + Seconds(2), now.utc + Seconds(2)};
      clock.watch(now);
      if (const auto utc = clock.to_store(now, [this] { return peers; })) stored.push_back(*utc);
    }
  }
  void jump(Duration by) { now.utc = now.utc + by; }
  /// The error of a peer's clock against this node's.
  void peer(Duration off) { peers.push_back((now.utc + off).ns - now.mono.ns); }
};

}  // namespace

TEST_CASE("a time is stored once the clock has run in step for ten minutes, then every ten") {
  Fixture fixture;
  fixture.run(minutes(10) - Seconds(2));
  CHECK(fixture.stored.empty());
  fixture.run(Seconds(2));
  REQUIRE(fixture.stored.size() == 1);
  CHECK(fixture.stored[0] == fixture.now.utc);
  fixture.run(minutes(30));
  CHECK(fixture.stored.size() == 4);
}

TEST_CASE("a clock that was 40 days ahead for 4 s leaves nothing behind") {
  Fixture fixture;
  fixture.run(minutes(20));
  const auto stored = fixture.stored;
  fixture.jump(hours(24 * 40));
  fixture.run(Seconds(4));
  fixture.jump(-hours(24 * 40));
  fixture.run(minutes(10) - Seconds(4));
  CHECK(fixture.stored == stored);
  fixture.run(Seconds(8));
  REQUIRE(fixture.stored.size() == stored.size() + 1);
  CHECK(fixture.stored.back() <= fixture.now.utc);
}

TEST_CASE("a jump is more than 2 s, whichever way; what a time server corrects little by little is none") {
  for (const Duration by : {Duration(Seconds(3)), Duration(-Seconds(3))}) {
    Fixture fixture;
    fixture.run(minutes(8));
    fixture.jump(by);
    fixture.run(minutes(9));
    CHECK(fixture.stored.empty());
  }
  Fixture slewed;
  for (int i = 0; i < 40; ++i) {
    slewed.jump(std::chrono::milliseconds(100));
    slewed.run(minutes(1));
  }
  CHECK(slewed.stored.size() >= 3);
}

TEST_CASE("two seconds to the dot are no jump yet, and five minutes ahead of the others not too much") {
  for (const Duration by : {Duration(Seconds(2)), Duration(-Seconds(2))}) {
    Fixture fixture;
    fixture.run(minutes(8));
    fixture.jump(by);
    fixture.run(minutes(3));
    CHECK(fixture.stored.size() == 1);
  }
  Fixture fixture;
  fixture.peer(-minutes(5));
  fixture.run(minutes(15));
  CHECK(fixture.stored.size() == 1);
}

TEST_CASE("a clock that is ahead of most peers' is not believed, however steady") {
  Fixture fixture;
  SUBCASE("of two of three") {
    fixture.peer(-minutes(6));
    fixture.peer(-hours(24 * 40));
    fixture.peer({});
    fixture.run(minutes(30));
    CHECK(fixture.stored.empty());
  }
  SUBCASE("a half of them is no majority, nor is one that is a little behind, or ahead") {
    fixture.peer(-minutes(6));
    fixture.peer(-minutes(4));
    fixture.peer(minutes(9));
    fixture.peer(-minutes(9));
    fixture.run(minutes(15));
    CHECK(fixture.stored.size() == 1);
  }
}

TEST_CASE("no clock overflows it") {
  for (const std::int64_t utc : {kMost, kLeast}) {
    Fixture fixture;
    fixture.peers = {kMost, kLeast, kLeast};
    fixture.now.utc = {utc};
    fixture.clock.watch(fixture.now);
    CHECK_FALSE(fixture.clock.to_store(fixture.now, [&] { return fixture.peers; }));
    fixture.clock.start({utc}, {{1}, {0}});
    CHECK_FALSE(fixture.clock.to_store({{2}, {0}}, [&] { return fixture.peers; }));
  }
}

TEST_CASE("a router whose clock jumps past the end of its certificate and back is a member again by itself") {
  for (const bool alone : {true, false}) {
    CAPTURE(alone);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant");
    if (!alone) fleet.start("bee");
    fleet.run(Seconds(3));
    ant.clock_off = hours(24 * 40);
    fleet.run(Seconds(4));
    CHECK(ant.count("own_certificate_over") == 1);
    ant.clock_off = {};
    const std::size_t beacons = ant.beacons.size();
    fleet.run(Seconds(8));
    CHECK(ant.beacons.size() > beacons);
    if (!alone) CHECK(ant.link_to("bee") != 0);
    CHECK(*ant.core->next_deadline() > fleet.now.mono);  // nothing stays due
    CHECK(ant.stored_utc.empty());
    CHECK(ant.core->answers().route_table(fleet.now).routes[0].clock == "verified");
  }
}

TEST_CASE("a jump of the clock does not throw away what another node has to be told") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  fleet.start("dog");
  fleet.run(Seconds(3));
  fleet.stop("dog");
  Certificate renewed = fleet.keys("dog").certificate;
  renewed.serial = 5;
  const SignedRecord record =
      sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(renewed), fleet.authority.key);
  Effects effects;
  REQUIRE(ant.core->updates().on_update({{}, {record}}, 0, fleet.now, effects));
  fleet.carry_out(ant, effects);
  fleet.run(Seconds(1));
  ant.clock_off = hours(24 * 40);
  fleet.run(Seconds(4));
  ant.clock_off = {};
  fleet.run(Seconds(8));
  REQUIRE(ant.link_to("bee") != 0);
  TestNode& dog = fleet.start("dog", {.boot = 2});
  fleet.run(Seconds(6));
  CHECK(dog.core->config().own.serial == 5);
}

TEST_CASE("a Hello may tell any time: nothing overflows, and it is told as a clock that is off") {
  for (const std::int64_t utc : {kMost, kLeast}) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    TestKeys& bee = fleet.keys("bee");
    fleet.authority.let_relay(bee);
    const Hello hello{bee.record, 3, "", "1", utc, true, {}, 0, "behind", true, ""};
    Effects effects;
    ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "", hello), 1,
                                 {{-5'000'000'000}, {-5}}, effects);
    fleet.carry_out(ant, effects);
    REQUIRE(ant.link_to("bee") == 9);
    // A node without the time takes a relay's: that, too, raises its bound.
    Effects words;
    const ReachablePeerList told{{fleet.keys("cat").record}, {}};
    ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "ant", told), 2,
                                 fleet.now, words);
    for (int i = 1; i < 5; ++i) ant.core->tick({fleet.now.mono + Seconds(i), {0}}, words);
    std::vector<std::int64_t> ends;
    for (const Effect& effect : words.list) {
      const auto* send = std::get_if<LinkSend>(&effect);
      if (send == nullptr || send->message.subtype != Relayed::kSubtype) continue;
      ends.push_back(decode<RelayedFrame>(decode<Relayed>(send->message.data)->record.payload.bytes)->expires);
    }
    REQUIRE_FALSE(ends.empty());
    CHECK((utc == kMost ? ends[0] == kMost : ends[0] < kStartUtc + 60'000'000'000));
  }
}

TEST_CASE("a router stores the time once its clock has run in step for ten minutes since it jumped last") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.run(minutes(9));
  ant.clock_off = Seconds(3);
  fleet.run(minutes(9));
  CHECK(ant.stored_utc.empty());
  fleet.run(minutes(2));
  CHECK(ant.stored_utc.size() == 1);
}
