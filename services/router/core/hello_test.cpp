// Strangers at the inbox: candidates, wrong Hellos, link ids of other connections.
#include <doctest/doctest.h>

#include "services/router/test/test_inbox.hpp"

using namespace trb;
using namespace trb::router;

namespace {

Bytes key_number(int number) {
  return Bytes(31, 'k') + static_cast<char>(number);
}

}  // namespace

TEST_CASE("a member that says Hello without end is kept out for a while, and its link stays") {
  Inbox inbox;
  LinkId link = 100;
  inbox.say_hello(link, inbox.bee);
  const LinkId first = inbox.ant.link_to("bee");
  CHECK(first == 100);
  for (int i = 0; i < 1000; ++i) inbox.say_hello(++link, inbox.bee);
  CHECK(inbox.ant.count("refused.too_many_hellos") > 900);
  CHECK(inbox.ant.core->table().link(link) == nullptr);
  REQUIRE(inbox.ant.refused.size() == inbox.ant.count("refused.too_many_hellos"));
  CHECK(decode<Goodbye>(inbox.ant.refused.back().message.data)->reason == "too many Hellos");
  CHECK_FALSE(inbox.admit(inbox.bee.link.public_key));
  CHECK(inbox.ant.count("refused.noisy_key") == 1);
  CHECK(inbox.admit(inbox.fleet.keys("cat").link.public_key));
  CHECK(inbox.ant.peer("bee")->link != 0);
  inbox.fleet.run(Seconds(9));
  CHECK_FALSE(inbox.admit(inbox.bee.link.public_key));
  inbox.fleet.run(Seconds(3));
  CHECK(inbox.admit(inbox.bee.link.public_key));
}

TEST_CASE("a member has three accepted links at most, however slowly it makes them") {
  Inbox inbox;
  for (LinkId link = 100; link < 140; ++link) {
    inbox.say_hello(link, inbox.bee);
    inbox.fleet.run(milliseconds(200));
    std::size_t links = 0;
    for (LinkId id = 100; id <= link; ++id) links += inbox.ant.core->table().link(id) != nullptr ? 1 : 0;
    CHECK(links <= 3);
    CHECK(inbox.ant.core->table().link(link) != nullptr);
  }
  CHECK(inbox.ant.count("refused.too_many_hellos") == 0);
}

TEST_CASE("a connection that carries a link and names another loses both") {
  Inbox inbox;
  inbox.say_hello(100, inbox.bee);
  REQUIRE(inbox.ant.link_to("bee") == 100);
  Effects effects;
  inbox.ant.core->links().on_second_link(100, inbox.fleet.now, effects);
  inbox.fleet.carry_out(inbox.ant, effects);
  CHECK(inbox.ant.link_to("bee") == 0);
  CHECK(inbox.ant.count("refused.second_hello") == 1);
  CHECK(inbox.ant.closed == std::vector<LinkId>{100});
}

TEST_CASE("a node of another version is refused by name, and told why in the version that it reads") {
  Inbox inbox;
  const Message message = make_message(MessageType::information, "bee", "", inbox.hello(inbox.bee));
  HeaderView header = header_of(message, 1);
  header.link = 100;
  const auto come = [&](const Bytes& key) {
    Effects effects;
    inbox.ant.core->handshake().on_other_version(0, key, 1, header, inbox.fleet.now, effects);
    inbox.fleet.carry_out(inbox.ant, effects);
  };
  come(inbox.bee.link.public_key);
  CHECK(inbox.ant.count("refused.version_mismatch") == 1);
  REQUIRE(inbox.ant.refused.size() == 1);
  CHECK(inbox.ant.refused[0].version == 1);
  CHECK(inbox.ant.refused[0].link == 100);
  const std::string why = decode<Goodbye>(inbox.ant.refused[0].message.data)->reason;
  CHECK(why == "version_mismatch: version 2 of the wire here, 1 there: install the same on both nodes");
  CHECK(inbox.ant.log.back().find("version_mismatch 'bee' speaks another") == 0);
  // An unproven name "bee" is not believed.
  come(key_number(1));
  CHECK(inbox.ant.log.back().find("a node that proves no name") != std::string::npos);
  // Nor in any message other than Hello.
  header.subtype = "profile";
  come(inbox.bee.link.public_key);
  CHECK(inbox.ant.log.back().find("a node that proves no name") != std::string::npos);
  CHECK(inbox.ant.link_to("bee") == 0);
}

TEST_CASE("of strangers thirty-two are let in, the next is refused, and a silent one is denied after two seconds") {
  Inbox inbox;
  for (int i = 0; i < 32; ++i) CHECK(inbox.admit(key_number(i)));
  CHECK_FALSE(inbox.admit(key_number(32)));
  CHECK(inbox.ant.count("refused.too_many_candidates") == 1);
  inbox.fleet.run(milliseconds(1900));
  CHECK(inbox.admit(key_number(0)));  // again: this gives no more time
  inbox.fleet.run(milliseconds(200));
  CHECK(inbox.ant.count("refused.no_hello") == 32);
  CHECK_FALSE(inbox.admit(key_number(0)));
  CHECK(inbox.ant.count("refused.denied_key") == 1);
  CHECK(inbox.admit(key_number(32)));
  inbox.fleet.run(Seconds(11));
  CHECK(inbox.admit(key_number(0)));
}

TEST_CASE("a Hello that does not hold is refused, and its reason is counted") {
  Inbox inbox;
  TestKeys thief = inbox.bee;
  thief.link = make_link_key();
  TestAuthority other_fleet;
  const TestKeys foreign = other_fleet.sign_node("bee");
  const TestKeys namesake = inbox.fleet.authority.sign_node("ant");
  inbox.say_hello(1, thief);
  CHECK(inbox.ant.count("refused.wrong_key") == 1);
  inbox.say_hello(2, foreign);
  CHECK(inbox.ant.count("refused.foreign_fleet") == 1);
  inbox.say_hello(3, namesake, "ant");
  CHECK(inbox.ant.count("refused.duplicate") == 1);
  inbox.say_hello(4, inbox.bee, "cat");
  CHECK(inbox.ant.count("refused.source_mismatch") == 1);
  CHECK(inbox.ant.refused.size() == 4);
  CHECK(inbox.ant.core->table().peers().empty());
  inbox.say_hello(5, thief);
  CHECK(inbox.ant.count("refused.denied_key") == 1);
  CHECK(inbox.ant.refused.size() == 4);
}

TEST_CASE("a stranger's Hello is bounded, needs a link id, and comes first") {
  Inbox inbox;
  Message large = make_message(MessageType::information, "bee", "", inbox.hello(inbox.bee));
  large.data.resize(kMaxHelloSize + 1);
  inbox.say(1, inbox.bee.link.public_key, large);
  CHECK(inbox.ant.count("refused.too_large") == 1);
  inbox.say_hello(0, inbox.fleet.keys("cat"), "cat");
  CHECK(inbox.ant.count("refused.malformed") == 1);
  inbox.say(2, inbox.fleet.keys("dog").link.public_key,
            make_message(MessageType::information, "dog", "", KeepAlive{1}));
  CHECK(inbox.ant.count("refused.unknown_peer_key") == 1);
  CHECK(inbox.ant.core->table().peers().empty());
}

TEST_CASE("a good Hello is accepted once") {
  Inbox inbox;
  inbox.say_hello(9, inbox.bee);
  CHECK(inbox.ant.link_to("bee") == 9);
  inbox.say_hello(9, inbox.bee);
  CHECK(inbox.ant.count("refused.repeated_hello") == 1);
  CHECK(inbox.ant.link_to("bee") == 9);
}

TEST_CASE("nobody speaks on another one's link, also on one that this node dialled") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(1));
  const LinkId link = ant.link_to("bee");
  REQUIRE(ant.core->table().link(link)->dialled);
  Effects effects;
  const Message goodbye = make_message(MessageType::information, "bee", "ant", Goodbye{"forged"});
  ant.core->inbox().on_message(link, fleet.keys("cat").link.public_key, goodbye, 99, fleet.now, effects);
  fleet.carry_out(ant, effects);
  CHECK(ant.count("refused.link_theft") == 1);
  // Nor does the peer itself by another connection, where nothing it says would be numbered and sealed.
  const Bytes frame = encode_frame(goodbye);
  HeaderView header = *decode_frame(frame);
  header.link = link;
  Effects again;
  ant.core->forwarding().from_stranger(fleet.keys("bee").link.public_key, header, frame, fleet.now, again);
  fleet.carry_out(ant, again);
  CHECK(ant.count("refused.link_theft") == 2);
  CHECK(ant.link_to("bee") == link);
}

TEST_CASE("a dialler that is refused hears so, does not shut the other out, and tries again") {
  TestFleet fleet;
  const TestKeys good = fleet.keys("bee");
  fleet.keys("ant").record.signature.bytes[0] ^= 1;
  fleet.start("bee", {.beacon = false});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.run(milliseconds(500));
  CHECK(ant.count("dial.refused") == 1);
  CHECK(fleet.at("bee").count("refused.bad_signature") == 1);
  Effects effects;
  CHECK(ant.core->admission().admit(good.link.public_key, fleet.now, effects));
  fleet.run(Seconds(6));
  CHECK(ant.dials.size() >= 4);
}

TEST_CASE("a routing table that is full takes no stranger, by a Hello or a beacon, and keeps whom it knows") {
  Inbox inbox;
  TestNode& ant = inbox.ant;
  const auto beacon = [&](const TestKeys& keys, std::uint64_t count) {
    const Beacon body{keys.record, "10.0.0.9:45000", 1, kStartUtc, count};
    const std::string& id = keys.certificate.id;
    Effects effects;
    ant.core->beacons().on_beacon(
        encode(sign(kSignedBeacon, id, inbox.fleet.authority.fleet.id(), encode(body), keys.identity)), inbox.fleet.now,
        effects);
    inbox.fleet.carry_out(ant, effects);
  };
  beacon(inbox.bee, 1);
  for (std::size_t i = 1; i < kMaxPeers; ++i) {
    if (i % kBeaconsChecked == 0) inbox.fleet.now.mono = inbox.fleet.now.mono + Seconds(1);
    beacon(inbox.fleet.authority.sign_node("node-" + std::to_string(i)), 1);
  }
  REQUIRE(ant.core->table().peers().size() == kMaxPeers);
  inbox.fleet.now.mono = inbox.fleet.now.mono + Seconds(1);
  const TestKeys cat = inbox.fleet.keys("cat");
  beacon(cat, 1);
  CHECK(ant.count("beacon.too_many_peers") == 1);
  inbox.say_hello(9, cat, "cat");
  CHECK(ant.count("refused.queue_full") == 1);
  CHECK(ant.peer("cat") == nullptr);
  beacon(inbox.bee, 2);
  CHECK(ant.count("beacon.too_many_peers") == 1);
  CHECK(ant.peer("bee")->beacon_count == 2);
  inbox.say_hello(10, inbox.bee);
  CHECK(ant.link_to("bee") == 10);
}

TEST_CASE("a member that was a stranger until its Hello is nobody that said nothing") {
  Inbox inbox;
  CHECK(inbox.admit(inbox.bee.link.public_key));
  CHECK(inbox.ant.count("candidates") == 1);
  inbox.say_hello(9, inbox.bee);
  inbox.fleet.run(Seconds(4));
  CHECK(inbox.ant.count("refused.no_hello") == 0);
}

TEST_CASE("a stranger that was refused makes room for the next one at once") {
  Inbox inbox;
  const TestAuthority elsewhere;
  const TestKeys foreign = elsewhere.sign_node("bee");
  CHECK(inbox.admit(foreign.link.public_key));
  inbox.say_hello(1, foreign);
  for (int i = 0; i < 32; ++i) CHECK(inbox.admit(key_number(i)));
  CHECK_FALSE(inbox.admit(key_number(32)));
  inbox.fleet.run(Seconds(3));
  CHECK(inbox.ant.count("refused.no_hello") == 32);
}

TEST_CASE("of strangers that were refused 256 are remembered") {
  Inbox inbox;
  for (int i = 0; i < 300; ++i) {
    const Bytes key = Bytes(30, 'k') + static_cast<char>(i % 100) + static_cast<char>(i / 100);
    inbox.say(1, key, make_message(MessageType::information, "dog", "", KeepAlive{1}));
  }
  int denied = 0;
  for (int i = 0; i < 300; ++i)
    denied += inbox.admit(Bytes(30, 'k') + static_cast<char>(i % 100) + static_cast<char>(i / 100)) ? 0 : 1;
  CHECK(inbox.ant.count("refused.denied_key") == 256);
  CHECK(denied == 256 + 300 - 256 - static_cast<int>(kMaxCandidates));
}

TEST_CASE("another computer under a name takes it over: the key of the one before is a stranger's") {
  Inbox inbox;
  inbox.say_hello(9, inbox.bee);
  const TestKeys fresh = inbox.fleet.authority.sign_node("bee", Role::robot, 2);
  Effects effects;
  inbox.ant.core->links().on_ended(9, LinkEndReason::disconnected, inbox.fleet.now, effects);
  inbox.fleet.carry_out(inbox.ant, effects);
  inbox.say_hello(10, fresh);
  REQUIRE(inbox.ant.link_to("bee") == 10);
  const Message word = make_message(MessageType::information, "bee", "", KeepAlive{1});
  inbox.say(11, fresh.link.public_key, word);
  CHECK(inbox.ant.count("dropped.closed_link") == 1);
  inbox.say(12, inbox.bee.link.public_key, word);
  CHECK(inbox.ant.count("refused.unknown_peer_key") == 1);
}

TEST_CASE("services hear of a peer that was started again or had expired, not of one whose link broke for a moment") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  const TestKeys bee = fleet.keys("bee");
  Effects effects;
  ant.core->bus().on_hello(1, {"resilience", {"peer_joined"}, 5, 100, "1"}, "resilience", fleet.now, effects);
  fleet.carry_out(ant, effects);
  LinkId link = 0;
  const auto come = [&](std::uint64_t boot) {
    const Hello hello{bee.record, boot, "10.0.0.2:45000", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects out;
    ant.core->inbox().on_message(++link, bee.link.public_key, make_message(MessageType::information, "bee", "", hello),
                                 1, fleet.now, out);
    ant.core->links().on_ended(link, LinkEndReason::disconnected, fleet.now, out);
    fleet.carry_out(ant, out);
    return ant.told("peer_joined");
  };
  CHECK(come(3) == 1);
  CHECK(come(3) == 1);
  CHECK(come(4) == 2);
  fleet.run(Seconds(11));
  REQUIRE(ant.peer("bee")->expired);
  CHECK(come(4) == 3);
}

TEST_CASE("a link ends at the moment at which its peer's certificate does, and is counted so") {
  Inbox inbox;
  TestKeys brief = inbox.bee;
  brief.certificate.not_after = kStartUtc + 2'000'000'000;
  brief.record = sign(kSignedCertificate, "", inbox.fleet.authority.fleet.id(), encode(brief.certificate),
                      inbox.fleet.authority.key);
  inbox.say_hello(9, brief);
  const MonotonicTime start = inbox.fleet.now.mono;
  const auto tick = [&](Duration after) {
    Effects effects;
    inbox.ant.core->tick({start + after, UtcTime{kStartUtc} + after}, effects);
    inbox.fleet.carry_out(inbox.ant, effects);
  };
  tick(Seconds(2) - Duration(1));
  CHECK(inbox.ant.link_to("bee") == 9);
  tick(Seconds(2));
  CHECK(inbox.ant.link_to("bee") == 0);
  CHECK(inbox.ant.count("refused.cert_expired") == 1);
}

TEST_CASE("a member that was noisy is let in again ten seconds later, to the moment") {
  Inbox inbox;
  for (LinkId link = 100; link < 110; ++link) inbox.say_hello(link, inbox.bee);
  REQUIRE(inbox.ant.count("refused.too_many_hellos") > 0);
  inbox.fleet.now.mono = inbox.fleet.now.mono + Seconds(10) - Duration(1);
  CHECK_FALSE(inbox.admit(inbox.bee.link.public_key));
  inbox.fleet.now.mono = inbox.fleet.now.mono + Duration(1);
  CHECK(inbox.admit(inbox.bee.link.public_key));
}

TEST_CASE("a Hello of 4096 bytes goes with its profile and is taken; of one byte more the profile follows") {
  NodeProfile profile;
  for (int i = 0; i < 80; ++i) profile.skills.push_back({"skill_number_" + std::to_string(i), "grab", {}, true, 2});
  const auto said = [&](const std::string& maker) {
    profile.maker = maker;
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    TestNode& bee = fleet.start("bee", {.beacon = false});
    Effects effects;
    ant.core->bus().on_hello(1, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", fleet.now, effects);
    ant.core->forwarding().on_bus_message(1, make_message(MessageType::information, "ant", "ant", profile), fleet.now,
                                          effects);
    fleet.carry_out(ant, effects);
    Message hello;
    std::size_t follow = 0;
    fleet.meddle = [&](const std::string& from, LinkId, std::uint64_t&, Message& message) {
      if (from == "ant" && message.subtype == Hello::kSubtype) hello = message;
      if (from == "ant" && message.subtype == NodeProfile::kSubtype) ++follow;
      return true;
    };
    fleet.run(Seconds(1));
    REQUIRE(bee.link_to("ant") != 0);
    CHECK(bee.peer("ant")->profile == profile);
    return std::pair(hello.data.size(), follow);
  };
  // The maker is a word of up to 64 letters; its skills fill the rest.
  auto [size, follow] = said(std::string(33, 'm'));
  while (size < kMaxHelloSize - 30) {
    profile.skills.back().name += std::string(std::min<std::size_t>(kMaxHelloSize - 30 - size, 30), 'x');
    profile.skills.push_back({"s", "grab", {}, true, 2});
    std::tie(size, follow) = said(std::string(33, 'm'));
  }
  REQUIRE(size <= kMaxHelloSize);
  const std::string maker(33 + kMaxHelloSize - size, 'm');
  REQUIRE(maker.size() < 64);
  CHECK(said(maker) == std::pair(kMaxHelloSize, std::size_t{0}));
  CHECK(said(maker + "m").second == 1);
}

TEST_CASE("where peers are is stored 5 s after one told a new address or was dialled, and for nothing else") {
  Inbox inbox;
  TestNode& ant = inbox.ant;
  const auto stores = [&](const std::string& address, LinkId link) {
    const Hello hello{inbox.bee.record, 3, address, "1", kStartUtc, true, {}, 0, "behind", false, ""};
    inbox.say(link, inbox.bee.link.public_key, make_message(MessageType::information, "bee", "", hello));
    REQUIRE(ant.link_to("bee") == link);
    ant.stored.clear();
    const MonotonicTime start = inbox.fleet.now.mono;
    const auto tick = [&](Duration after) {
      inbox.fleet.now.mono = start + after;
      Effects effects;
      ant.core->tick(inbox.fleet.now, effects);
      inbox.fleet.carry_out(ant, effects);
      return !ant.stored.empty();
    };
    CHECK_FALSE(tick(Seconds(5) - Duration(1)));
    const bool stored = tick(Seconds(5));
    Effects effects;
    ant.core->links().on_ended(link, LinkEndReason::disconnected, inbox.fleet.now, effects);
    inbox.fleet.carry_out(ant, effects);
    return stored;
  };
  CHECK(stores("10.0.0.2:45000", 9));
  CHECK_FALSE(stores("10.0.0.2:45000", 10));
  CHECK(stores("10.0.0.3:45000", 11));
}
