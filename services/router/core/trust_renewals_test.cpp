// Renewed certificates: kept, passed on, refused. Time is injected, nothing sleeps.
#include "services/router/test/test_trust.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;

TEST_CASE("a renewed certificate reaches its node and all others, and no link is lost by it") {
  Three three;
  const LinkId link = three.ant.link_to("cat");
  const SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  const SignedRecord of_ant = three.sign_certificate(three.renewed("ant", 6));
  REQUIRE(three.tell(three.bee, {{}, {renewed, of_ant}}).ok());
  three.fleet.run(milliseconds(100));
  CHECK(three.cat.stored_certificates == std::vector{renewed});
  CHECK(three.cat.core->config().own.serial == 5);
  CHECK(three.ant.peer("cat")->certificate.serial == 5);
  CHECK(three.ant.link_to("cat") == link);
  // The old one would have ended after a day.
  three.fleet.now.utc = three.fleet.now.utc + hours(30);
  three.fleet.run(Seconds(5));
  CHECK(three.ant.link_to("cat") == link);
  CHECK(three.ant.link_to("bee") == 0);
  CHECK(logged(three.bee, "own_certificate_over this node's certificate ended"));
}

TEST_CASE("an older certificate, and one for other keys, are no renewal") {
  Three three;
  const SignedRecord newest = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {{}, {newest}}).ok());
  CHECK(three.code(three.ant, {{}, {three.sign_certificate(three.renewed("cat", 4))}}) == Errc::downgraded);
  CHECK(three.code(three.ant, {{}, {newest}}) == Errc::ok);
  Certificate other_keys = three.renewed("ant", 9);
  other_keys.link_key.bytes = Bytes(32, 'x');
  CHECK(three.code(three.ant, {{}, {three.sign_certificate(other_keys)}}) == Errc::wrong_key);
  Certificate later = three.renewed("cat", 10);
  later.not_before = kStartUtc + 3'600'000'000'000;
  CHECK(three.code(three.ant, {{}, {three.sign_certificate(later)}}) == Errc::cert_not_yet_valid);
}

TEST_CASE("a renewal with another role is not taken by a node that runs: its services were started for the old one") {
  Three three;
  Certificate other = three.renewed("ant", 9);
  other.role = other.role == Role::cloud ? Role::robot : Role::cloud;
  CHECK(three.code(three.ant, {{}, {three.sign_certificate(other)}}) == Errc::bad_value);
  CHECK(three.ant.stored_certificates.empty());
}

TEST_CASE("a renewal that has ended is no longer told to those that join") {
  Three three;
  three.fleet.stop("cat");
  Certificate brief = three.renewed("cat", 5);
  brief.not_after = kStartUtc + 60'000'000'000;
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(brief)}}).ok());
  three.fleet.stop("bee");
  three.fleet.run(Seconds(70));
  TestNode& bee = three.fleet.start("bee", {.boot = 2});
  three.fleet.run(Seconds(4));
  REQUIRE(bee.link_to("ant") != 0);
  CHECK(bee.count("refused.cert_expired") == 0);
}

TEST_CASE("a certificate with other keys is remembered for the node that will come with them; the link keeps the old") {
  Three three;
  Certificate anew = of_another(three.fleet, "cat", 5);
  SUBCASE("both are others") {}
  SUBCASE("only the link's") {
    anew.identity_key = three.cat.keys.certificate.identity_key;
  }
  SUBCASE("only the node's") {
    anew.link_key = three.cat.keys.certificate.link_key;
  }
  const LinkId link = three.ant.link_to("cat");
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(anew)}}).ok());
  CHECK(three.ant.peer("cat")->certificate.serial == 1);
  CHECK(three.ant.link_to("cat") == link);
  CHECK(three.ant.stored_updates.back().update.certificates.size() == 1);
  // This node itself accepts no certificate with other keys than its own.
  Certificate own = three.renewed("ant", 9);
  own.identity_key = anew.identity_key;
  CHECK(three.code(three.ant, {{}, {three.sign_certificate(own)}}) == Errc::wrong_key);
}

TEST_CASE("of others 1024 renewals are kept and 256 told on; one more finds no room, a newer one of the same does") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  const auto tell = [&](const std::string& id, std::uint64_t serial) {
    Certificate certificate = fleet.keys("ant").certificate;
    certificate.id = id;
    certificate.serial = serial;
    Effects effects;
    auto taken = ant.core->updates().on_update(
        {{}, {sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key)}}, 0,
        fleet.now, effects);
    ant.stored_updates.clear();
    fleet.carry_out(ant, effects);
    return taken ? Errc::ok : taken.error().code;
  };
  std::size_t taken = 0;
  for (std::size_t i = 0; i < kMaxPeers; ++i) taken += tell("n" + std::to_string(i), 2) == Errc::ok ? 1 : 0;
  CHECK(taken == kMaxPeers);
  CHECK(ant.stored_updates.back().update.certificates.size() == 256);
  CHECK(tell("one-more", 2) == Errc::queue_full);
  CHECK(tell("n7", 3) == Errc::ok);
}

TEST_CASE("who links again is told what it does not know, and no renewal that its node has shown itself") {
  Three three;
  three.fleet.stop("cat");
  three.fleet.stop("bee");
  const SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {renewed}}).ok());
  CHECK(three.ant.stored_updates.back().update.certificates.size() == 1);
  TestNode& bee = three.fleet.start("bee", {.boot = 2});
  three.fleet.run(Seconds(4));
  CHECK(bee.count("news.lists") == 1);
  CHECK(bee.count("news.certificates") == 1);
  three.fleet.start("cat", {.boot = 2});
  three.fleet.run(Seconds(4));
  REQUIRE(three.ant.link_to("cat") != 0);
  REQUIRE(three.ant.link_to("bee") != 0);
  // All nodes have all of them by now.
  std::size_t told = 0;
  three.fleet.meddle = [&](const std::string&, LinkId, std::uint64_t&, Message& message) {
    told += message.subtype == TrustUpdate::kSubtype ? 1 : 0;
    return true;
  };
  for (const std::string other : {"bee", "cat"}) {
    three.fleet.cut("ant", other);
    three.fleet.cut(other, "ant");
  }
  three.fleet.run(Seconds(12));
  REQUIRE(three.ant.link_to("bee") == 0);
  three.fleet.heal();
  three.fleet.run(Seconds(8));
  REQUIRE(three.ant.link_to("bee") != 0);
  CHECK(told == 0);
}

TEST_CASE("a refused node is handed what it does not know, and nothing else") {
  Three three;
  TestNode& ant = three.ant;
  const auto hello = [&](const TestKeys& keys, std::uint64_t list) {
    Effects effects;
    ant.refused.clear();
    const Hello said{keys.record, 9, "10.0.0.9:1", "1", kStartUtc, true, {}, list, "behind", false, ""};
    ant.core->inbox().on_message(random_u64(), keys.link.public_key,
                                 make_message(MessageType::information, keys.certificate.id, "", said), 1,
                                 three.fleet.now, effects);
    three.fleet.carry_out(ant, effects);
    return std::any_of(ant.refused.begin(), ant.refused.end(),
                       [](const RefuseCandidate& one) { return one.message.subtype == TrustUpdate::kSubtype; });
  };
  SUBCASE("the list, unless it says that it has it") {
    REQUIRE(three.tell(ant, {list_of(three.fleet.authority, 2, {"dog", "eel"}), {}}).ok());
    CHECK(hello(three.fleet.authority.sign_node("dog"), 1));
    CHECK_FALSE(hello(three.fleet.authority.sign_node("eel"), 2));
  }
  SUBCASE("a newer certificate that this node has of it by its own word") {
    three.fleet.stop("cat");
    TestKeys cat = three.fleet.keys("cat");
    TestKeys old = cat;
    old.certificate.serial = 0;
    old.record = three.sign_certificate(old.certificate);
    CHECK(hello(old, 0));
    REQUIRE_FALSE(ant.refused.empty());
    CHECK(decode<TrustUpdate>(ant.refused.front().message.data)->certificates == std::vector{cat.record});
  }
  SUBCASE("nothing, if its certificate is the newest and has ended") {
    three.fleet.stop("cat");
    three.fleet.now.utc = three.fleet.now.utc + hours(25);
    CHECK_FALSE(hello(three.fleet.keys("cat"), 0));
    CHECK_FALSE(ant.refused.empty());
  }
  SUBCASE("nothing, if its certificate is not valid yet, though a later one is known") {
    Certificate renewed = of_another(three.fleet, "dog", 5);
    REQUIRE(three.tell(ant, {{}, {three.sign_certificate(renewed)}}).ok());
    TestKeys early = three.fleet.authority.sign_node("dog", Role::robot, 6);
    early.certificate.not_before = kStartUtc + 3'600'000'000'000;
    early.record = three.sign_certificate(early.certificate);
    CHECK_FALSE(hello(early, 0));
    CHECK_FALSE(ant.refused.empty());
  }
}
