// Links between nodes: found, dialled, doubled, lost, found again. Time is injected, nothing sleeps.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

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

TEST_CASE("two nodes meet by beacon: the smaller id dials, the greater waits") {
  TestFleet fleet;
  fleet.start("ant");
  fleet.start("bee");
  fleet.run(milliseconds(500));
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
  fleet.cut("ant", "bee");  // bee hears nothing of the end
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
  CHECK(fleet.at("bee").count("beacon.replayed") > 0);  // until the link has proven which boot is here now
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

TEST_CASE("replayed, foreign and damaged beacons are counted and lead nowhere") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  fleet.run(Seconds(1));
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

TEST_CASE("a certificate that ends takes its link with it") {
  TestFleet fleet;
  fleet.keys("bee").certificate.not_after = kStartUtc + 5'000'000'000;
  TestKeys& keys = fleet.keys("bee");
  keys.record = sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(keys.certificate), fleet.authority.key);
  fleet.start("ant");
  fleet.start("bee");
  fleet.run(Seconds(1));
  check_linked(fleet, "ant", "bee");
  fleet.run(Seconds(8));
  CHECK(fleet.at("ant").link_to("bee") == 0);
}

TEST_CASE("a frame that is none ends its link under a name of its own, not as a gap in the sequence") {
  TestFleet fleet;
  fleet.start("ant");
  fleet.start("bee");
  fleet.run(milliseconds(500));
  const LinkId link = fleet.at("bee").link_to("ant");
  Effects effects;
  fleet.at("bee").core->links().on_bad_frame(link, fail(Errc::malformed, "header: no array"), fleet.now, effects);
  fleet.carry_out(fleet.at("bee"), effects);
  CHECK(fleet.at("bee").link_to("ant") == 0);
  CHECK(fleet.at("bee").count("refused.malformed") == 1);
  CHECK(fleet.at("bee").count("refused.sequence") == 0);
  fleet.run(Seconds(5));
  check_linked(fleet, "ant", "bee");
}

TEST_CASE("a Hello read after its dialler gave it up takes nothing: the link that is there stays until a second word") {
  TestFleet fleet;
  fleet.start("ant", {.beacon = false});
  TestNode& bee = fleet.start("bee", {.beacon = false, .seeds = {"ant"}});
  fleet.run(Seconds(2));
  const LinkId live = bee.link_to("ant");
  REQUIRE(live != 0);

  // ant, whose dial would win, has closed the connection long before bee comes to read what was in it.
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

TEST_CASE("a member that asks for tables without end is told no more than its bytes of a second, by name") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  fleet.start("cat");
  fleet.run(Seconds(1));
  const auto ask = [&](const std::string& who, const auto& question) {
    const LinkId link = ant.link_to(who);
    const std::uint64_t next = ant.core->table().link(link)->heard + 1;
    Effects effects;
    ant.core->inbox().on_message(link, ant.core->table().link(link)->key,
                                 make_message(MessageType::request, who, "ant", question), next, fleet.now, effects);
    for (const Effect& effect : effects.list) {
      if (const auto* send = std::get_if<LinkSend>(&effect)) return send->message;
    }
    return Message{};
  };
  std::size_t bytes = 0;
  Message answer;
  for (int i = 0; i < 100'000 && answer.subtype != Nack::kSubtype; ++i) {
    answer = ask("bee", RouteListRequest{});
    bytes += answer.data.size();
  }
  REQUIRE(answer.subtype == Nack::kSubtype);
  CHECK(decode<Nack>(answer.data)->code == "queue_full");
  CHECK(bytes > kAnsweredOfOne);
  CHECK(bytes < kAnsweredOfOne + (2U << 10U) * 10);
  CHECK(ask("bee", RouterCountersRequest{}).subtype == Nack::kSubtype);
  // An echo is no longer than its question; another member has bytes of its own.
  CHECK(ask("bee", EchoRequest{}).subtype == Echo::kSubtype);
  CHECK(ask("cat", RouteListRequest{}).subtype == RouteTable::kSubtype);
  fleet.run(Seconds(1));
  CHECK(ask("bee", RouteListRequest{}).subtype == RouteTable::kSubtype);
}

TEST_CASE("what a peer may not ask is Nacked if it asks, and not if it only tells or answers") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  fleet.run(Seconds(1));
  const LinkId link = ant.link_to("bee");
  const auto nacks = [&](const Message& message) {
    Effects effects;
    ant.core->inbox().on_message(link, ant.core->table().link(link)->key, message, 99, fleet.now, effects);
    for (const std::string& name : effects.counts) ++ant.counts[name];
    return std::count_if(effects.list.begin(), effects.list.end(), [](const Effect& effect) {
      const auto* send = std::get_if<LinkSend>(&effect);
      return send != nullptr && send->message.subtype == Nack::kSubtype;
    });
  };
  Message message = make_message(MessageType::request, "bee", "ant", ServiceHello{});
  CHECK(nacks(message) == 1);
  CHECK(ant.count("refused.not_permitted") == 1);
  message.data = "noise";
  CHECK(nacks(message) == 1);
  message.reply_to = 5;
  CHECK(nacks(message) == 0);
  message.reply_to = 0;
  message.type = MessageType::information;
  CHECK(nacks(message) == 0);
}

TEST_CASE("the end of one dial says nothing of another: each seed is dialled again after its own") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee", "cat"}});
  fleet.start("cat", {.beacon = false});
  fleet.cut("ant", "cat");  // it does not answer; nobody at all is where bee should be
  const auto dials = [&](const std::string& to) {
    return std::count_if(ant.dials.begin(), ant.dials.end(),
                         [&](const Dial& dial) { return dial.address == fleet.address(to); });
  };
  fleet.run(milliseconds(2150));
  CHECK(dials("bee") == 4);  // at once, then 0.2, 0.4 and 0.8 s later
  CHECK(dials("cat") == 1);
  fleet.run(milliseconds(150));
  CHECK(dials("cat") == 2);  // two seconds for its Hello, and 0.2 s
}

TEST_CASE("who is reached by a relay is dialled more seldom than who is not reached at all") {
  for (const bool relay : {true, false}) {
    CAPTURE(relay);
    TestFleet fleet;
    fleet.start("cloud", {.beacon = false, .relay = relay});
    TestNode& ant = fleet.start("ant", {.seeds = {"cloud"}});
    fleet.start("bee", {.seeds = {"cloud"}});
    fleet.run(Seconds(3));
    check_linked(fleet, "ant", "bee");
    fleet.cut("ant", "bee");
    fleet.cut("bee", "ant");
    fleet.run(Seconds(40));
    CHECK(ant.link_to("bee") == 0);
    CHECK(ant.relay_route("bee").open == relay);
    const std::size_t before = ant.dials.size();
    fleet.run(Seconds(60));
    // Each dial waits two seconds for its Hello, and then four seconds or two.
    CHECK(ant.dials.size() - before == (relay ? 10 : 15));
  }
}

TEST_CASE("a dial that is answered by anything but a Hello has failed; only a Goodbye that can be read tells why") {
  const auto answered = [](const std::string& subtype, const Bytes& data) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    fleet.start("bee", {.beacon = false});
    fleet.withhold = [](const std::string& from, const Message&) { return from == "bee"; };
    fleet.run(2 * kStep);
    Message word = make_message(MessageType::information, "bee", "", Goodbye{});
    word.subtype = subtype;
    word.data = data;
    fleet.arrive(ant, ant.dials.back().link, 1, word);
    CHECK(ant.count("dial.refused") == 1);
    CHECK(ant.core->table().link(ant.dials.back().link) == nullptr);
    return ant.log.back();
  };
  CHECK(answered("goodbye", encode(Goodbye{"other fleet"})) == "dial_ended unproven: refused: other fleet");
  CHECK(answered("goodbye", "noise") == "dial_ended unproven: answered without Hello");
  CHECK(answered("keep_alive", encode(Goodbye{"other fleet"})) == "dial_ended unproven: answered without Hello");
}

namespace {

bool says(const Effects& effects, std::string_view subtype) {
  return std::any_of(effects.list.begin(), effects.list.end(), [&](const Effect& effect) {
    const auto* send = std::get_if<LinkSend>(&effect);
    return send != nullptr && send->message.subtype == subtype;
  });
}

template <class T>
bool has(const Effects& effects) {
  return std::any_of(effects.list.begin(), effects.list.end(),
                     [](const Effect& effect) { return std::holds_alternative<T>(effect); });
}

}  // namespace

TEST_CASE("a link that is closed here ends with a seal and a Goodbye; one that broke, or was never up, with neither") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee", "cat", "dog"}});
  for (const char* id : {"bee", "cat", "dog"}) fleet.start(id, {.beacon = false});
  fleet.cut("ant", "dog");
  fleet.run(Seconds(1));
  const LinkId dial = std::find_if(ant.dials.begin(), ant.dials.end(), [&](const Dial& one) {
                        return one.address == fleet.address("dog");
                      })->link;
  Effects closed;
  ant.core->links().on_bad_frame(ant.link_to("bee"), fail(Errc::malformed, "header: no array"), fleet.now, closed);
  CHECK(says(closed, Goodbye::kSubtype));
  CHECK(has<SealDue>(closed));
  CHECK_FALSE(has<ReturnHeld>(closed));  // what came by it was delivered at once
  Effects broken;
  ant.core->links().on_ended(ant.link_to("cat"), LinkEnd::disconnected, fleet.now, broken);
  CHECK(has<CloseLink>(broken));
  CHECK_FALSE(says(broken, Goodbye::kSubtype));
  CHECK_FALSE(has<SealDue>(broken));
  Effects never;
  ant.core->links().on_bad_frame(dial, fail(Errc::malformed, "header: no array"), fleet.now, never);
  CHECK(has<CloseLink>(never));
  CHECK_FALSE(says(never, Goodbye::kSubtype));
  CHECK_FALSE(has<SealDue>(never));
}

TEST_CASE("how a dial ended is counted, unless nobody was there or the connection broke, as happens every day") {
  for (const auto how : {LinkEnd::failed, LinkEnd::disconnected, LinkEnd::refused_key, LinkEnd::no_curve}) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    fleet.start("bee", {.beacon = false});
    fleet.cut("ant", "bee");
    fleet.run(kStep);
    Effects effects;
    ant.core->links().on_ended(ant.dials.back().link, how, fleet.now, effects);
    const bool counted = how == LinkEnd::refused_key || how == LinkEnd::no_curve;
    CHECK(effects.counts ==
          (counted ? std::vector<std::string>{"dial." + std::string(name_of(how))} : std::vector<std::string>{}));
  }
}

TEST_CASE("a keep-alive is confirmed by one that has heard it, and by none that has heard only what was before it") {
  for (const bool heard : {true, false}) {
    CAPTURE(heard);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    const TestKeys bee = fleet.keys("bee");
    const Hello hello{bee.record, 3, "10.0.0.2:45000", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    const auto say = [&](const auto& body) {
      Effects effects;
      ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "ant", body),
                                   1, fleet.now, effects);
      fleet.carry_out(ant, effects);
    };
    say(hello);
    fleet.run(milliseconds(2500));
    const auto& sent = ant.core->table().link(9)->unconfirmed;
    REQUIRE(sent.size() == 1);
    say(KeepAlive{sent.front() - (heard ? 0 : 1)});
    CHECK(ant.core->table().link(9)->unconfirmed.empty() == heard);
    CHECK((ant.core->table().link(9)->confirmed == fleet.now.mono) == heard);
  }
}
