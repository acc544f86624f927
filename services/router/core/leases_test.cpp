// What time does to links, dials, strangers and beacons, to the moment: one node, whose clock the test moves.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Clock {
  TestFleet fleet;
  TestNode& node;
  MonotonicTime start = fleet.now.mono;

  explicit Clock(const std::string& id = "ant", const TestFleet::Options& options = {.beacon = false})
      : node(fleet.start(id, options)) {}

  Now at(Duration after) {
    fleet.now = {start + after, UtcTime{kStartUtc} + after};
    return fleet.now;
  }
  Effects tick(Duration after) {
    Effects effects;
    node.core->tick(at(after), effects);
    fleet.carry_out(node, effects);
    return effects;
  }
  /// The bee dials and sends Hello.
  void greet(LinkId link, const std::string& address = "10.0.0.2:45000") {
    const TestKeys bee = fleet.keys("bee");
    const Hello hello{bee.record, 3, address, "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects effects;
    node.core->inbox().on_message(link, bee.link.public_key, make_message(MessageType::information, "bee", "", hello),
                                  1, fleet.now, effects);
    fleet.carry_out(node, effects);
    REQUIRE(node.link_to("bee") == link);
  }
  void end(LinkId link, Duration after) {
    Effects effects;
    node.core->links().on_ended(link, LinkEndReason::disconnected, at(after), effects);
    fleet.carry_out(node, effects);
  }
  /// A message comes by the bee's link.
  void hear(LinkId link, Duration after) {
    Effects effects;
    Message word = make_message(MessageType::information, "bee", node.id, KeepAlive{0});
    word.subtype = "note";
    const std::uint64_t next = node.core->table().link(link)->heard + 1;
    node.core->forwarding().from_link(link, header_of(word, next, link), encode_frame(word), at(after), effects);
  }
  void beacon(std::uint64_t boot, std::uint64_t count, Duration after, const std::string& address = "10.0.0.2:45000") {
    const TestKeys bee = fleet.keys("bee");
    const Beacon body{bee.record, address, boot, kStartUtc, count};
    Effects effects;
    node.core->beacons().on_beacon(
        encode(sign(kSignedBeacon, "bee", fleet.authority.fleet.id(), encode(body), bee.identity)), at(after), effects);
    fleet.carry_out(node, effects);
  }
  bool admit(const Bytes& key, Duration after) {
    Effects effects;
    const bool good = node.core->admission().admit(key, at(after), effects);
    fleet.carry_out(node, effects);
    return good;
  }
  /// A stranger sends something other than Hello.
  void speak(const Bytes& key, Duration after) {
    Effects effects;
    node.core->inbox().on_message(4711, key, make_message(MessageType::information, "dog", "", KeepAlive{1}), 1,
                                  at(after), effects);
    fleet.carry_out(node, effects);
  }
  [[nodiscard]] bool logged(const std::string& line) const {
    return std::find(node.log.begin(), node.log.end(), line) != node.log.end();
  }
};

Bytes stranger(int number) {
  return Bytes(30, 'k') + static_cast<char>(number % 100) + static_cast<char>(number / 100);
}

/// The position of the first effect of this kind.
template <class Is>
std::optional<std::size_t> place_of(const Effects& effects, const Is& is) {
  const auto at = std::find_if(effects.list.begin(), effects.list.end(), is);
  if (at == effects.list.end()) return std::nullopt;
  return static_cast<std::size_t>(at - effects.list.begin());
}

bool is_keep_alive(const Effect& effect) {
  const auto* send = std::get_if<LinkSend>(&effect);
  return send != nullptr && send->message.subtype == KeepAlive::kSubtype;
}

bool beacons(const Effects& effects) {
  return place_of(effects, [](const Effect& effect) { return std::holds_alternative<SendBeacon>(effect); }).has_value();
}

}  // namespace

TEST_CASE("a keep-alive leaves each 2.5 s, to the moment, behind a seal over what was said before it") {
  Clock clock;
  clock.greet(9);
  CHECK_FALSE(place_of(clock.tick(milliseconds(2500) - kInstant), is_keep_alive));
  Bytes frame = encode_frame(make_message(MessageType::information, "ant", "bee", KeepAlive{0}));
  REQUIRE(clock.node.core->seals().send(9, frame.data(), frame.size(), clock.fleet.now).known);
  const Effects due = clock.tick(milliseconds(2500));
  const auto alive = place_of(due, is_keep_alive);
  const auto seal = place_of(due, [](const Effect& effect) { return std::holds_alternative<SealDue>(effect); });
  REQUIRE(alive);
  REQUIRE(seal);
  CHECK(*seal < *alive);
  CHECK_FALSE(place_of(clock.tick(milliseconds(5000) - kInstant), is_keep_alive));
  CHECK(place_of(clock.tick(milliseconds(5000)), is_keep_alive));
}

TEST_CASE("a node that was dialled has two seconds to the moment for its Hello") {
  Clock clock("ant", {.beacon = false, .seeds = {"bee"}});
  clock.fleet.start("bee", {.beacon = false});
  clock.fleet.cut("ant", "bee");
  clock.tick({});
  REQUIRE(clock.node.dials.size() == 1);
  const LinkId dial = clock.node.dials[0].link;
  clock.tick(Seconds(2) - kInstant);
  CHECK(clock.node.core->table().link(dial) != nullptr);
  clock.tick(Seconds(2));
  CHECK(clock.node.core->table().link(dial) == nullptr);
  CHECK(clock.logged("dial_ended unproven: no Hello in time"));
}

TEST_CASE("a link by which nothing comes ends a lease after its last word, as not heard, whatever beacons come") {
  Clock clock;
  clock.greet(9);
  clock.beacon(3, 1, Seconds(5));
  clock.tick(Seconds(10) - kInstant);
  CHECK(clock.node.link_to("bee") == 9);
  clock.tick(Seconds(10));
  CHECK(clock.node.link_to("bee") == 0);
  CHECK(clock.logged("link_closed bee: nothing heard for a lease"));
}

TEST_CASE("a link that is not confirmed for a lease ends, as one-way if the peer was heard in the last six seconds") {
  const auto why = [](Duration word, Duration beacon) {
    Clock clock;
    clock.greet(9);
    clock.hear(9, word);
    if (beacon != Duration{}) clock.beacon(3, 1, beacon);
    clock.tick(Seconds(10) - kInstant);
    CHECK(clock.node.link_to("bee") == 9);
    clock.tick(Seconds(10));
    CHECK(clock.node.link_to("bee") == 0);
    return clock.logged("link_closed bee: not heard by the other side for a lease") ? "one way"
           : clock.logged("link_closed bee: nothing heard for a lease")             ? "not heard"
                                                                                    : "";
  };
  CHECK(why(Seconds(4) + kInstant, {}) == std::string("one way"));
  CHECK(why(Seconds(4), {}) == std::string("not heard"));
  CHECK(why(Seconds(1), Seconds(5)) == std::string("one way"));
  CHECK(why(Seconds(1), Seconds(3)) == std::string("not heard"));
}

TEST_CASE("of a peer that told no address a router waits for the end of its lease, and then for nothing") {
  Clock clock;
  clock.greet(9, "");
  clock.end(9, Seconds(1));
  clock.tick(Seconds(1));  // what was said on the link is sealed no more
  CHECK(clock.node.core->next_deadline() == clock.start + milliseconds(1200));
  const Effects redial = clock.tick(milliseconds(1200));
  CHECK_FALSE(place_of(redial, [](const Effect& effect) { return std::holds_alternative<Dial>(effect); }));
  CHECK(clock.node.core->next_deadline() == clock.start + Seconds(10));
  clock.tick(Seconds(10) - kInstant);
  CHECK_FALSE(clock.node.peer("bee")->expired);
  clock.tick(Seconds(10));
  CHECK(clock.node.peer("bee")->expired);
  CHECK(clock.node.count("peer_expired") == 1);
  CHECK(clock.node.core->next_deadline() == std::nullopt);
}

TEST_CASE("a node that a beacon names while its seed is being dialled is dialled by the beacon once that has ended") {
  Clock clock("ant", {.beacon = false, .seeds = {"bee"}});
  clock.fleet.start("bee", {.beacon = false});
  clock.fleet.cut("ant", "bee");
  clock.tick({});
  clock.beacon(3, 1, milliseconds(100), clock.fleet.address("bee"));
  clock.tick(milliseconds(100));
  clock.tick(milliseconds(300));
  CHECK(clock.node.dials.size() == 1);
  clock.tick(Seconds(2));
  CHECK(clock.node.dials.size() == 2);
}

TEST_CASE("a stranger that says nothing is refused after two seconds, and kept out for ten, to the moment") {
  Clock clock;
  const Bytes key = stranger(1);
  CHECK(clock.admit(key, {}));
  clock.tick(Seconds(2) - kInstant);
  CHECK(clock.node.count("refused.no_hello") == 0);
  clock.tick(Seconds(2));
  CHECK(clock.node.count("refused.no_hello") == 1);
  CHECK_FALSE(clock.admit(key, Seconds(12) - kInstant));
  clock.speak(key, Seconds(12) - kInstant);
  CHECK(clock.node.count("refused.denied_key") == 2);
  CHECK(clock.admit(key, Seconds(12)));
  clock.speak(key, Seconds(12));
  CHECK(clock.node.count("refused.denied_key") == 2);
  CHECK(clock.node.count("refused.unknown_peer_key") == 1);
}

TEST_CASE(
    "a silent stranger beyond the 256 that are kept out is not, and when their time is over there is room again") {
  Clock clock;
  const Bytes silent = stranger(1000);
  const Bytes next = stranger(1001);
  for (int i = 0; i < 256; ++i) clock.speak(stranger(i), {});
  CHECK(clock.admit(silent, {}));
  clock.tick(Seconds(2));
  CHECK(clock.node.count("refused.no_hello") == 1);
  CHECK(clock.admit(silent, Seconds(2)));
  clock.tick(Seconds(10));
  clock.speak(next, Seconds(10));
  CHECK_FALSE(clock.admit(next, Seconds(10)));
}

TEST_CASE("a beacon of an earlier boot says nothing of a link that is up; once that has ended it is believed") {
  Clock clock;
  clock.greet(9);
  clock.beacon(2, 1, milliseconds(100));
  CHECK(clock.node.count("beacon.replayed") == 1);
  CHECK(clock.node.link_to("bee") == 9);
  clock.end(9, milliseconds(200));
  clock.beacon(2, 1, milliseconds(300));
  CHECK(clock.node.count("beacon.replayed") == 1);
  CHECK(clock.node.peer("bee")->beacon_boot == 2);
}

TEST_CASE("a router starts with a burst of beacons, then sends one each five seconds, to the moment") {
  Clock clock("ant", {});
  Duration due{};
  for (const Duration pause : {Duration{}, Duration(milliseconds(300)), Duration(milliseconds(300)),
                               Duration(milliseconds(300)), Duration(Seconds(5)), Duration(Seconds(5))}) {
    due += pause;
    CHECK_FALSE(beacons(clock.tick(due - kInstant)));
    CHECK(clock.node.core->next_deadline() == clock.start + due);
    CHECK(beacons(clock.tick(due)));
  }
}

TEST_CASE(
    "the greater id answers a beacon with one of its own within 0.2 s, unless it has just sent one or sends none") {
  const auto answers = [](const std::string& id, bool sends, Duration heard) {
    Clock clock(id, {.beacon = sends});
    for (const int due : {0, 300, 600, 900}) clock.tick(milliseconds(due));  // the burst at the start
    clock.beacon(3, 1, heard);
    CHECK_FALSE(beacons(clock.tick(heard + milliseconds(200) - kInstant)));
    return beacons(clock.tick(heard + milliseconds(200)));
  };
  CHECK(answers("cat", true, milliseconds(1300) + kInstant));
  CHECK_FALSE(answers("cat", true, milliseconds(1300)));
  CHECK_FALSE(answers("cat", false, milliseconds(1600)));
  CHECK_FALSE(answers("ant", true, milliseconds(1600)));
}
