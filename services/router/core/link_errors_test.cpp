// Which errors of its links a router remembers, for `trb doctor`.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// The request that `trb doctor` sends.
LinkErrorTable ask(TestFleet& fleet, TestNode& node) {
  Effects effects;
  node.core->bus().on_hello(7, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
  Message question = make_message(MessageType::request, node.id, node.id, LinkErrorTableRequest{});
  node.core->forwarding().on_bus_message(7, question, fleet.now, effects);
  for (const Effect& effect : effects.list) {
    const auto* send = std::get_if<BusSend>(&effect);
    if (send == nullptr || send->message.subtype != LinkErrorTable::kSubtype) continue;
    return *decode<LinkErrorTable>(send->message.data);
  }
  return {};
}

bool has_error(const LinkErrorTable& table, const std::string& peer, const std::string& code) {
  return std::any_of(table.errors.begin(), table.errors.end(),
                     [&](const LinkErrorRow& row) { return row.peer == peer && row.code == code; });
}

/// Two nodes with a link.
struct Linked {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(5));
  TestNode& bee = fleet.at("bee");
  Linked() { REQUIRE(ant.link_to("bee") != 0); }
};

}  // namespace

TEST_CASE("a peer that cannot be dialled is told of until a link to it is up") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.run(Seconds(5));
  const LinkErrorTable down = ask(fleet, ant);
  REQUIRE(down.errors.size() == 1);
  CHECK(down.node == "ant");
  CHECK(down.errors[0].code == "failed");
  CHECK(down.errors[0].count > 1);
  CHECK(down.errors[0].last_s < 3);
  CHECK_FALSE(down.errors[0].address.empty());
  fleet.start("bee", {.beacon = false});
  fleet.run(Seconds(5));
  REQUIRE(ant.link_to("bee") != 0);
  CHECK(ask(fleet, ant).errors.empty());
}

TEST_CASE("a one-way cut is told apart from silence") {
  Linked linked;
  auto& [fleet, ant, bee] = linked;
  fleet.cut("ant", "bee");
  fleet.run(Seconds(14));
  CHECK(has_error(ask(fleet, bee), "ant", "not_heard"));
  CHECK(has_error(ask(fleet, ant), "bee", "one_way"));
}

TEST_CASE("a cut both ways is silence on both sides") {
  Linked linked;
  auto& [fleet, ant, bee] = linked;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.run(Seconds(14));
  CHECK(has_error(ask(fleet, bee), "ant", "not_heard"));
  CHECK(has_error(ask(fleet, ant), "bee", "not_heard"));
  CHECK_FALSE(has_error(ask(fleet, ant), "bee", "one_way"));
  fleet.heal();
  fleet.run(Seconds(5));
  REQUIRE(ant.link_to("bee") != 0);
  CHECK(ask(fleet, ant).errors.empty());
  CHECK(ask(fleet, bee).errors.empty());
}

TEST_CASE("what a link that comes up ends is its peer's and its address's trouble, and nobody else's") {
  const PeerTable none{RouterConfig{}};
  LinkErrors errors{none};
  const Now now{{1'000'000'000}, {}};
  const auto codes = [&] {
    std::string out;
    for (const LinkErrorRow& row : errors.table("ant", now.mono).errors) out += row.code;
    return out;
  };
  errors.note("", "", "a", "", now);
  errors.note("", "host:1", "b", "", now);
  errors.note("bee", "", "c", "", now);
  errors.note("cat", "host:2", "d", "", now);
  CHECK(codes() == "abcd");  // of the same moment, so sorted by name
  errors.recovered("", "");
  CHECK(codes() == "abcd");
  errors.recovered("", "host:1");
  CHECK(codes() == "acd");
  errors.recovered("bee", "");
  CHECK(codes() == "ad");
  errors.recovered("dog", "host:2");
  CHECK(codes() == "a");
}

TEST_CASE("a trouble that comes again is no new row and pushes none out; of the same age the first by name goes") {
  const PeerTable none{RouterConfig{}};
  LinkErrors errors{none};
  for (std::size_t i = 0; i < kMaxLinkErrors; ++i) errors.note("", std::to_string(100 + i), "x", "", Now{{5}, {}});
  errors.note("", "120", "x", "again", Now{{6}, {}});
  REQUIRE(errors.table("ant", MonotonicTime{9}).errors.size() == kMaxLinkErrors);
  CHECK(errors.table("ant", MonotonicTime{9}).errors.front().count == 2);
  const auto there = [&](const std::string& address) {
    const LinkErrorTable table = errors.table("ant", MonotonicTime{9});
    return std::any_of(table.errors.begin(), table.errors.end(),
                       [&](const LinkErrorRow& row) { return row.address == address; });
  };
  CHECK(there("100"));
  errors.note("", "new", "x", "", Now{{7}, {}});
  CHECK_FALSE(there("100"));
  CHECK(there("355"));
}

TEST_CASE("a trouble is written down under whom its link belongs to") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee", "cat"}});
  fleet.start("bee", {.beacon = false});
  fleet.cut("ant", "cat");
  fleet.start("cat", {.beacon = false});
  fleet.run(milliseconds(100));
  REQUIRE(ant.link_to("bee") != 0);
  const auto row = [&](const std::string& code) {
    for (const LinkErrorRow& one : ask(fleet, ant).errors) {
      if (one.code == code) return one.peer + "@" + one.address;
    }
    return std::string("none");
  };
  ant.core->errors().note_link(0, "nobodys", "", fleet.now);
  CHECK(row("nobodys") == "@");
  ant.core->errors().note_link(ant.link_to("bee"), "of_bee", "", fleet.now);
  CHECK(row("of_bee") == "bee@");
  const auto dial = std::find_if(ant.dials.begin(), ant.dials.end(),
                                 [&](const Dial& one) { return one.address == fleet.address("cat"); });
  REQUIRE(dial != ant.dials.end());
  ant.core->errors().note_link(dial->link, "of_a_seed", "", fleet.now);
  CHECK(row("of_a_seed") == "@" + fleet.address("cat"));
  // A peer that was linked is dialled as a peer, not as a seed.
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  fleet.run(Seconds(12));
  LinkId last = 0;
  for (const Dial& one : ant.dials) last = one.address == fleet.address("bee") ? one.link : last;
  REQUIRE(ant.core->table().link(last) != nullptr);
  ant.core->errors().note_link(last, "of_a_peer", "", fleet.now);
  CHECK(row("of_a_peer") == "bee@" + fleet.address("bee"));
}

TEST_CASE("a member whose clock is minutes away is told of, though its link is up") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const TestKeys bee = fleet.keys("bee");
  const auto hello = [&](std::int64_t utc) {
    const Hello body{bee.record, 3, "10.0.0.2:1", "1", utc, true, {}, 0, "behind", false, ""};
    return make_message(MessageType::information, "bee", "", body);
  };
  Effects effects;
  ant.core->inbox().on_message(9, bee.link.public_key, hello(kStartUtc + 300'000'000'000), 1, fleet.now, effects);
  fleet.carry_out(ant, effects);
  REQUIRE(ant.link_to("bee") == 9);
  CHECK(has_error(ask(fleet, ant), "bee", "clock_off"));
}

TEST_CASE("a clock is told of when it is over a minute away, before or behind") {
  constexpr std::int64_t kMinute = 60'000'000'000;
  const auto told = [](std::int64_t off) {
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false});
    const TestKeys bee = fleet.keys("bee");
    const Hello body{bee.record, 3, "10.0.0.2:1", "1", fleet.now.utc.ns + off, true, {}, 0, "behind", false, ""};
    Effects effects;
    ant.core->inbox().on_message(9, bee.link.public_key, make_message(MessageType::information, "bee", "", body), 1,
                                 fleet.now, effects);
    fleet.carry_out(ant, effects);
    REQUIRE(ant.link_to("bee") == 9);
    return has_error(ask(fleet, ant), "bee", "clock_off");
  };
  CHECK_FALSE(told(kMinute));
  CHECK(told(kMinute + 1));
  CHECK_FALSE(told(-kMinute));
  CHECK(told(-kMinute - 1));
}

TEST_CASE("a stranger's certificate and a beacon that does not open leave a row each") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  TestAuthority other;
  const TestKeys foreign = other.sign_node("bee");
  const Hello body{foreign.record, 1, "10.0.0.2:1", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  Effects effects;
  ant.core->inbox().on_message(5, foreign.link.public_key, make_message(MessageType::information, "bee", "", body), 1,
                               fleet.now, effects);
  ant.core->beacons().refuse("foreign_fleet", "beacon of another fleet", fleet.now, effects);
  fleet.carry_out(ant, effects);
  const LinkErrorTable table = ask(fleet, ant);
  CHECK(has_error(table, "", "foreign_fleet"));
  CHECK(has_error(table, "", "beacon.foreign_fleet"));
}

TEST_CASE("a node that was dialled and shows a certificate that does not hold leaves a row with its address") {
  TestFleet fleet;
  fleet.keys("bee").record.signature.bytes[0] ^= 1;
  fleet.start("bee", {.beacon = false});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.run(Seconds(1));
  const LinkErrorTable table = ask(fleet, ant);
  REQUIRE(table.errors.size() == 1);
  CHECK(table.errors[0].code == "bad_signature");
  CHECK(table.errors[0].address == fleet.address("bee"));
}

TEST_CASE("a node that is refused where it dials writes down that it was, and with which word") {
  TestFleet fleet;
  fleet.keys("ant").record.signature.bytes[0] ^= 1;
  fleet.start("bee", {.beacon = false});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.run(std::chrono::milliseconds(500));
  const LinkErrorTable table = ask(fleet, ant);
  REQUIRE_FALSE(table.errors.empty());
  CHECK(table.errors.back().code == "refused_us");
  CHECK(table.errors.back().text == "bad_signature");
}

TEST_CASE("a node of another version leaves a row, by its name once that is proven") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const TestKeys bee = fleet.keys("bee");
  const Hello body{bee.record, 1, "", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  const Message hello = make_message(MessageType::information, "bee", "", body);
  Effects effects;
  ant.core->handshake().on_other_version(0, bee.link.public_key, 1, header_of(hello, 1), fleet.now, effects);
  CHECK(has_error(ask(fleet, ant), "bee", "version_mismatch"));
}

TEST_CASE("troubles are bounded, and the oldest gives way") {
  const PeerTable none{RouterConfig{}};
  LinkErrors errors{none};
  for (int i = 0; i < 300; ++i) errors.note("", "host:" + std::to_string(i), "failed", "", Now{{i + 1}, {}});
  const LinkErrorTable table = errors.table("ant", MonotonicTime{1000});
  REQUIRE(table.errors.size() == kMaxLinkErrors);
  CHECK(table.errors.front().address == "host:299");
  CHECK(table.errors.back().address == "host:44");
}

TEST_CASE("a peer with ever new addresses pushes out its own troubles, and nobody else's") {
  const PeerTable none{RouterConfig{}};
  LinkErrors errors{none};
  errors.note("bee", "", "clock_off", "", Now{{1}, {}});
  errors.note("", "", "unknown_peer_key", "", Now{{2}, {}});
  for (int i = 0; i < 1000; ++i) errors.note("evil", "10.0.0.9:" + std::to_string(i), "failed", "", Now{{i + 3}, {}});
  const LinkErrorTable table = errors.table("ant", MonotonicTime{2000});
  CHECK(table.errors.size() == kMaxLinkErrors);
  CHECK(table.errors.front().address == "10.0.0.9:999");
  CHECK(has_error(table, "bee", "clock_off"));
  CHECK(has_error(table, "", "unknown_peer_key"));
}

TEST_CASE("a router sends back what it is asked to echo") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  Effects effects;
  ant.core->bus().on_hello(7, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
  const EchoRequest question{{std::string(8000, 'x')}};
  ant.core->forwarding().on_bus_message(7, make_message(MessageType::request, "ant", "ant", question), fleet.now,
                                        effects);
  const auto* send = std::get_if<BusSend>(&effects.list.back());
  REQUIRE(send != nullptr);
  CHECK(decode<Echo>(send->message.data)->pad == question.pad);
}

TEST_CASE(
    "a revocation is written down: that of another node, and this node's own under a name that no stranger can use") {
  TestFleet fleet;
  const std::vector<TestNode*> nodes = {&fleet.start("ant"), &fleet.start("bee"), &fleet.start("cat")};
  fleet.run(Seconds(2));
  RevocationList list;
  list.fleet = {fleet.authority.fleet.id()};
  list.number = 1;
  list.revoked = {{1, "cat", "stolen", kStartUtc}};
  const SignedRecord record =
      sign(kSignedRevocations, "", fleet.authority.fleet.id(), encode(list), fleet.authority.key);
  Effects effects;
  REQUIRE(nodes[0]->core->updates().on_update({record, {}}, 0, fleet.now, effects));
  fleet.carry_out(*nodes[0], effects);
  fleet.run(Seconds(1));
  CHECK(has_error(ask(fleet, *nodes[0]), "cat", "cert_revoked"));
  CHECK(has_error(ask(fleet, *nodes[1]), "cat", "cert_revoked"));
  CHECK(has_error(ask(fleet, *nodes[2]), "cat", "own.cert_revoked"));
}

TEST_CASE("a stranger's trouble bears no name that it has not proven") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(2));
  for (const std::string name : {"ant", "bee", "nobody"}) {
    TestKeys intruder = TestFleet().authority.sign_node(name, Role::robot);
    const Hello hello{intruder.record, 1, "x", "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects effects;
    ant.core->inbox().on_message(random_u64(), intruder.link.public_key,
                                 make_message(MessageType::information, name, "", hello), 1, fleet.now, effects);
    fleet.carry_out(ant, effects);
    CHECK_FALSE(has_error(ask(fleet, ant), name, "foreign_fleet"));
  }
  CHECK(has_error(ask(fleet, ant), "", "foreign_fleet"));
  // A node whose certificate has ended is named: its key and its authority's signature prove the name.
  TestKeys dog = fleet.authority.sign_node("dog", Role::robot);
  dog.certificate.not_after = kStartUtc - 1;
  dog.record = sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(dog.certificate), fleet.authority.key);
  const Hello late{dog.record, 1, "x", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  Effects effects;
  ant.core->inbox().on_message(random_u64(), dog.link.public_key,
                               make_message(MessageType::information, "dog", "", late), 1, fleet.now, effects);
  CHECK(has_error(ask(fleet, ant), "dog", "cert_expired"));
}

TEST_CASE("a frame that is none leaves a row of the peer that sent it") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(milliseconds(500));
  Effects effects;
  ant.core->links().on_bad_frame(ant.link_to("bee"), fail(Errc::malformed, "header: no array"), fleet.now, effects);
  CHECK(has_error(ask(fleet, ant), "bee", "malformed"));
}
