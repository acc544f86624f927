// What the authority says while the fleet is up: who is out, whose certificate was renewed, what time it is.
#include <doctest/doctest.h>

#include "common/security/revocations.hpp"
#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;
using std::chrono::milliseconds;
using Seconds = std::chrono::seconds;

namespace {

SignedRecord sign_list(const TestAuthority& authority, RevocationList list) {
  list.fleet = {authority.fleet.id()};
  list.issued = kStartUtc;
  return sign(kSignedRevocations, "", authority.fleet.id(), encode(list), authority.key);
}

/// List `number`: these ids are out up to serial 1; the beacon key's box is for those that are named.
SignedRecord list_of(const TestAuthority& authority, std::uint64_t number, const std::vector<std::string>& out_ids,
                     const std::vector<std::string>& staying = {}) {
  RevocationList list;
  list.number = number;
  list.beacon_number = static_cast<std::uint32_t>(number + 1);
  for (const std::string& id : out_ids) list.revoked.push_back({1, id, "stolen", kStartUtc});
  for (const std::string& id : staying) list.beacon_keys.push_back({id, {Bytes(80, 'b')}});
  return sign_list(authority, list);
}

/// Three linked nodes: ant, bee, cat.
struct Three {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");
  TestNode& cat = fleet.start("cat");
  Three() {
    fleet.run(Seconds(2));
    REQUIRE(linked({&ant, &bee, &cat}));
  }
  static bool linked(const std::vector<TestNode*>& nodes) {
    for (const TestNode* a : nodes) {
      for (const TestNode* b : nodes) {
        if (a != b && a->link_to(b->id) == 0) return false;
      }
    }
    return true;
  }
  Result<std::string> tell(TestNode& node, const FleetNews& news) {
    Effects effects;
    auto taken = node.core->updates().on_update(news, 0, fleet.now, effects);
    fleet.carry_out(node, effects);
    return taken;
  }
  Errc code(TestNode& node, const FleetNews& news) {
    const auto taken = tell(node, news);
    return taken ? Errc::ok : taken.error().code;
  }
  Certificate renewed(const std::string& id, std::uint64_t serial) {
    Certificate certificate = fleet.keys(id).certificate;
    certificate.serial = serial;
    certificate.not_after = kStartUtc + std::chrono::nanoseconds(hours(24 * 300)).count();
    return certificate;
  }
  SignedRecord sign_certificate(const Certificate& certificate) const {
    return sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key);
  }
};

bool logged(const TestNode& node, const std::string& text) {
  return std::any_of(node.log.begin(), node.log.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("a revocation that one node hears of is in force on all, and the revoked node knows it") {
  Three three;
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 1, {"cat"}, {"ant", "bee"}), {}}).ok());
  CHECK(three.ant.peer("cat") == nullptr);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee.peer("cat") == nullptr);
  CHECK(three.ant.count("refused.cert_revoked") == 1);
  CHECK(three.bee.count("refused.cert_revoked") == 1);
  CHECK(logged(three.cat, "own_certificate_over this node's certificate is revoked: stolen"));
  Effects effects;
  CHECK_FALSE(three.cat.core->admission().admit(three.ant.keys.link.public_key, three.fleet.now, effects));
  three.cat.beacons.clear();
  const std::size_t dials = three.cat.dials.size();
  three.fleet.run(Seconds(20));
  CHECK(three.cat.beacons.empty());
  CHECK(three.cat.dials.size() == dials);
  CHECK(Three::linked({&three.ant, &three.bee}));
  CHECK(three.ant.peer("cat") == nullptr);
}

TEST_CASE("a list is on disk before anything is done about it, and the beacon key's box goes with it") {
  Three three;
  Effects effects;
  REQUIRE(three.ant.core->updates()
              .on_update({list_of(three.fleet.authority, 1, {"cat"}, {"ant", "bee"}), {}}, 0, three.fleet.now, effects)
              .ok());
  std::optional<std::size_t> stored;
  for (std::size_t i = 0; i < effects.list.size(); ++i) {
    if (std::holds_alternative<StoreNews>(effects.list[i])) stored = i;
    if (std::holds_alternative<LinkSend>(effects.list[i]) || std::holds_alternative<CloseLink>(effects.list[i])) {
      CHECK(stored.has_value());
    }
  }
  REQUIRE(stored);
  const auto& store = std::get<StoreNews>(effects.list[*stored]);
  CHECK(store.beacon_number == 2);
  CHECK(store.beacon_box == Bytes(80, 'b'));
}

TEST_CASE("a revoked node's key, Hello and beacon are refused, and services hear that it is gone") {
  Three three;
  TestNode& ant = three.ant;
  Effects effects;
  ant.core->bus().on_hello(1, {"resilience", {"peer_expired"}, 1, 1, "1"}, "resilience", three.fleet.now, effects);
  const Bytes beacon = three.cat.beacons.back();
  REQUIRE(three.tell(ant, {list_of(three.fleet.authority, 1, {"cat"}), {}}).ok());
  CHECK(ant.told("peer_expired") == 1);
  CHECK_FALSE(ant.core->admission().admit(three.cat.keys.link.public_key, three.fleet.now, effects));
  ant.core->beacons().on_beacon(beacon, three.fleet.now, effects);
  three.fleet.carry_out(ant, effects);
  CHECK(ant.count("beacon.cert_revoked") == 1);
  const Hello hello{three.cat.keys.record, 9, "cat", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  ant.core->inbox().on_message(77, three.cat.keys.link.public_key,
                               make_message(MessageType::information, "cat", "", hello), 1, three.fleet.now, effects);
  three.fleet.carry_out(ant, effects);
  CHECK(ant.count("refused.cert_revoked") >= 3);
  CHECK(ant.peer("cat") == nullptr);
}

TEST_CASE("a revoked node that this one never met is refused at its Hello and handed the list") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false});
  Effects effects;
  REQUIRE(ant.core->updates().on_update({list_of(fleet.authority, 1, {"dog"}), {}}, 0, fleet.now, effects).ok());
  fleet.carry_out(ant, effects);
  TestNode& dog = fleet.start("dog", {.beacon = false, .seeds = {"ant"}});
  fleet.run(Seconds(1));
  CHECK(ant.count("refused.cert_revoked") >= 1);
  CHECK(ant.refused.front().message.subtype == FleetNews::kSubtype);
  CHECK(logged(dog, "own_certificate_over"));
  const std::size_t dials = dog.dials.size();
  fleet.run(Seconds(10));
  CHECK(dog.dials.size() == dials);
}

TEST_CASE("older, forged, foreign and doubled lists are refused, each under its own name") {
  Three three;
  const TestAuthority other;
  const TestAuthority& authority = three.fleet.authority;
  CHECK(three.code(three.ant, {list_of(authority, 2, {}), {}}) == Errc::ok);
  CHECK(three.code(three.ant, {list_of(authority, 2, {}), {}}) == Errc::ok);  // the same: nothing new
  CHECK(three.code(three.ant, {list_of(authority, 1, {"cat"}), {}}) == Errc::downgraded);
  CHECK(three.code(three.ant, {list_of(authority, 0, {"cat"}), {}}) == Errc::downgraded);
  CHECK(three.code(three.ant, {list_of(authority, 2, {"cat"}), {}}) == Errc::conflict);
  CHECK(three.code(three.ant, {list_of(other, 3, {"cat"}), {}}) == Errc::foreign_fleet);
  SignedRecord forged = list_of(authority, 3, {"cat"});
  forged.signature.bytes[5] ^= 1;
  CHECK(three.code(three.ant, {forged, {}}) == Errc::bad_signature);
  SignedRecord garbage = forged;
  garbage.payload.bytes = "noise";
  CHECK(three.code(three.ant, {garbage, {}}) == Errc::malformed);
  CHECK(Three::linked({&three.ant, &three.bee, &three.cat}));
}

TEST_CASE("a member that brings a forged list is counted and stays linked") {
  Three three;
  SignedRecord forged = list_of(three.fleet.authority, 3, {"cat"});
  forged.signature.bytes[5] ^= 1;
  const LinkId link = three.ant.link_to("bee");
  const std::uint64_t next = three.ant.core->table().link(link)->heard + 1;
  three.fleet.arrive(three.ant, link, next,
                     make_message(MessageType::information, "bee", "ant", FleetNews{forged, {}}));
  CHECK(three.ant.count("refused.bad_signature") == 1);
  CHECK(three.ant.link_to("bee") == link);
}

TEST_CASE("a node that was away hears the list when it is linked again") {
  Three three;
  three.fleet.stop("bee");
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 4, {"cat"}), {}}).ok());
  TestNode& bee = three.fleet.start("bee", {.boot = 2});
  three.fleet.run(Seconds(2));
  CHECK(bee.count("news.lists") == 1);
  CHECK(bee.link_to("ant") != 0);
  CHECK(bee.peer("cat") == nullptr);
}

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

TEST_CASE("256 copies of one certificate cost one check, and a member's news no more than 300 a second") {
  Three three;
  Certificate fresh = three.renewed("cat", 2);
  const SignedRecord record =
      sign(kSignedCertificate, "", three.fleet.authority.fleet.id(), encode(fresh), three.fleet.authority.key);
  FleetNews copies;
  copies.certificates.assign(256, record);
  const auto tell = [&](const FleetNews& news) {
    Effects effects;
    effects.add(LinkSend{three.bee.link_to("ant"), make_message(MessageType::information, "bee", "ant", news)});
    three.fleet.carry_out(three.bee, effects);
    three.fleet.run(2 * kStep);
  };
  tell(copies);
  CHECK(three.ant.count("news.certificates") == 1);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == kUpdatesChecked - 1);
  tell(copies);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == kUpdatesChecked - 1);

  // Each of them the authority's, and none of them new.
  FleetNews old;
  for (std::uint64_t i = 0; i < 256; ++i) {
    const TestKeys keys = three.fleet.authority.sign_node("cat", Role::robot, 1);
    old.certificates.push_back(keys.record);
  }
  tell(old);
  tell(old);
  CHECK(three.ant.core->table().peers().at("bee").update_checks.left() == 0);
  CHECK(three.ant.link_to("bee") != 0);
}

TEST_CASE("over sixteen news of one member in a second are not even read; another's are") {
  Three three;
  const auto tell = [&](TestNode& from, const FleetNews& news) {
    Effects effects;
    effects.add(LinkSend{from.link_to("ant"), make_message(MessageType::information, from.id, "ant", news)});
    three.fleet.carry_out(from, effects);
  };
  for (int i = 0; i < 40; ++i) tell(three.bee, {});
  tell(three.cat, {list_of(three.fleet.authority, 1, {"dog"}), {}});
  three.fleet.run(2 * kStep);
  CHECK(three.ant.count("refused.too_much_news") == 24);
  CHECK(three.ant.count("news.lists") == 1);
}

TEST_CASE("that a list is refused is told, whatever came with it") {
  Three three;
  const SignedRecord known = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 3, {}), {known}}).ok());
  const SignedRecord fresh = three.sign_certificate(three.renewed("bee", 6));
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 3, {"cat"}), {known}}) == Errc::conflict);
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 2, {}), {fresh}}) == Errc::downgraded);
  CHECK(three.ant.peer("bee")->certificate.serial == 6);
}

TEST_CASE("of a message with a forged certificate nothing behind it is looked at") {
  Three three;
  SignedRecord forged = three.sign_certificate(three.renewed("bee", 8));
  forged.signature.bytes[3] ^= 1;
  const SignedRecord good = three.sign_certificate(three.renewed("cat", 9));
  CHECK(three.code(three.ant, {{}, {forged, forged, good}}) == Errc::bad_signature);
  CHECK(three.ant.count("news.certificates") == 0);
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

TEST_CASE(
    "a node that was away while it was renewed is refused with its old certificate, handed the new one, and joins") {
  Three three;
  three.fleet.stop("cat");
  const SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {{}, {renewed}}).ok());
  three.fleet.run(Seconds(1));
  TestNode& cat = three.fleet.start("cat", {.boot = 2});
  three.fleet.run(Seconds(4));
  CHECK(cat.core->config().own.serial == 5);
  CHECK(Three::linked({&three.ant, &three.bee, &cat}));
  CHECK(three.ant.count("refused.downgraded") + three.bee.count("refused.downgraded") >= 1);
}

TEST_CASE("the end of a certificate is told a month before, once a day, in the log and to a person who asks") {
  Three three;  // its certificates are valid for a day
  CHECK(logged(three.ant, "certificate_ends certificate ends"));
  three.ant.log.clear();
  three.fleet.run(Seconds(30));
  CHECK_FALSE(logged(three.ant, "certificate_ends"));
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(three.renewed("ant", 5))}}).ok());
  three.fleet.run(Seconds(1));
  CHECK_FALSE(logged(three.ant, "certificate_ends"));
}

TEST_CASE("a node that starts in 1970 joins, unverified, by what the authority has signed since") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  // bee was certified an hour after ant, and ant's clock knows nothing of it.
  TestKeys& bee_keys = fleet.keys("bee");
  bee_keys.certificate.not_before = kStartUtc + 3'600'000'000'000;
  bee_keys.certificate.not_after = kStartUtc + 90'000'000'000'000;
  bee_keys.record =
      sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(bee_keys.certificate), fleet.authority.key);
  SUBCASE("a clock that can be right refuses it") {
    fleet.start("bee");
    fleet.run(Seconds(2));
    CHECK(ant.link_to("bee") == 0);
    CHECK(ant.count("beacon.cert_not_yet_valid") + ant.count("refused.cert_not_yet_valid") > 0);
  }
  SUBCASE("a clock that is certainly behind learns from it") {
    fleet.now.utc = {0};
    TestNode& late = fleet.start("dog");
    fleet.start("bee");
    fleet.run(Seconds(2));
    CHECK(late.link_to("bee") != 0);
    CHECK(late.core->answers().route_table(fleet.now).routes[0].clock == "unverified");
    CHECK(std::find(late.stored_utc.begin(), late.stored_utc.end(), UtcTime{kStartUtc + 3'600'000'000'000}) !=
          late.stored_utc.end());
  }
}

namespace {

/// As a later release would write it: with a field behind those that are known here.
SignedRecord sign_long(const TestAuthority& authority, const Certificate& certificate, std::size_t more) {
  Bytes payload = encode(certificate);
  payload[0] = static_cast<char>(payload[0] + 1);
  payload.append({'\xc5', static_cast<char>(more >> 8U), static_cast<char>(more & 0xffU)});
  payload.append(more, 'x');
  return sign(kSignedCertificate, "", authority.fleet.id(), payload, authority.key);
}

/// All that was said of news from one node to another since this began to listen.
struct Heard {
  std::vector<FleetNews> news;
  Heard(TestFleet& fleet, const std::string& from, TestNode& node, const std::string& to) {
    fleet.meddle = [this, from, &node, to](const std::string& by, LinkId link, std::uint64_t&, Message& message) {
      if (by == from && link == node.link_to(to) && message.subtype == FleetNews::kSubtype)
        news.push_back(*decode<FleetNews>(message.data));
      return true;
    };
  }
};

Certificate of_another(const TestFleet& fleet, const std::string& id, std::uint64_t serial) {
  return fleet.authority.sign_node(id, Role::robot, serial).certificate;
}

}  // namespace

TEST_CASE("who brings news is not told them again, the others are, and who asked hears how many") {
  Three three;
  Heard back(three.fleet, "ant", three.ant, "bee");
  Effects effects;
  const FleetNews news{list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {}};
  const auto taken = three.ant.core->updates().on_update(news, three.ant.link_to("bee"), three.fleet.now, effects);
  three.fleet.carry_out(three.ant, effects);
  three.fleet.run(2 * kStep);
  REQUIRE(taken.ok());
  CHECK(*taken == "list 1, 0 renewed certificates, told to 1 nodes");
  CHECK(back.news.empty());
  CHECK(three.cat.count("news.lists") == 1);
  CHECK(three.ant.stored_utc.empty());  // its clock is right
}

TEST_CASE("one certificate that is refused hides neither what is behind it nor what is known") {
  Three three;
  const SignedRecord old = three.sign_certificate(three.renewed("cat", 0));
  const SignedRecord fresh = three.sign_certificate(three.renewed("bee", 6));
  CHECK(three.code(three.ant, {{}, {old, fresh}}) == Errc::ok);
  CHECK(three.ant.peer("bee")->certificate.serial == 6);
  CHECK(three.code(three.ant, {{}, {old, fresh}}) == Errc::ok);  // nothing new
  CHECK(three.code(three.ant, {{}, {old}}) == Errc::downgraded);
  const SignedRecord list = list_of(three.fleet.authority, 3, {});
  CHECK(three.code(three.ant, {list, {}}) == Errc::ok);
  CHECK(three.code(three.ant, {list, {old}}) == Errc::ok);
  CHECK(three.code(three.ant, {list_of(three.fleet.authority, 2, {}), {fresh}}) == Errc::downgraded);
}

TEST_CASE("what a node knows already costs no signature, whoever's it is") {
  Three three;
  const SignedRecord away = three.sign_certificate(of_another(three.fleet, "dog", 4));
  REQUIRE(three.tell(three.ant, {{}, {away}}).ok());
  const std::uint64_t taken = three.ant.count("news.certificates");
  const std::uint32_t left = three.ant.peer("bee")->update_checks.left();
  Effects effects;
  const FleetNews known{{}, {three.ant.keys.record, three.cat.keys.record, away}};
  const auto told = three.ant.core->updates().on_update(known, three.ant.link_to("bee"), three.fleet.now, effects);
  CHECK(*told == "nothing new");
  CHECK(effects.list.empty());
  CHECK(three.ant.peer("bee")->update_checks.left() == left);
  CHECK(three.ant.count("news.certificates") == taken);
}

TEST_CASE("a member whose signatures of this second are spent brings not even a list") {
  Three three;
  FleetNews noise;
  for (std::uint64_t i = 0; i < 256; ++i) noise.certificates.push_back(three.sign_certificate(three.renewed("cat", 0)));
  const auto bring = [&](const FleetNews& news) {
    Effects effects;
    const auto taken = three.ant.core->updates().on_update(news, three.ant.link_to("bee"), three.fleet.now, effects);
    three.fleet.carry_out(three.ant, effects);
    return taken ? Errc::ok : taken.error().code;
  };
  CHECK(bring(noise) == Errc::downgraded);
  CHECK(bring(noise) == Errc::queue_full);
  REQUIRE(three.ant.peer("bee")->update_checks.left() == 0);
  CHECK(bring({list_of(three.fleet.authority, 1, {"dog"}), {}}) == Errc::ok);
  CHECK(three.ant.count("news.lists") == 0);
  three.fleet.run(Seconds(2));
  CHECK(bring({list_of(three.fleet.authority, 1, {"dog"}), {}}) == Errc::ok);
  CHECK(three.ant.count("news.lists") == 1);
}

TEST_CASE("an old file that was left on the node is no attack; one that the authority has not signed is told") {
  Three three;
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 3, {}), {}}).ok());
  const auto read = [&](const SignedRecord& list) {
    Effects effects;
    three.ant.core->updates().on_file({list, {}}, three.fleet.now, effects);
    three.fleet.carry_out(three.ant, effects);
  };
  read(list_of(three.fleet.authority, 2, {}));
  read(list_of(three.fleet.authority, 3, {}));
  CHECK_FALSE(logged(three.ant, "news_refused"));
  read(list_of(TestAuthority(), 4, {}));
  CHECK(three.ant.count("refused.foreign_fleet") == 1);
  CHECK(logged(three.ant, "news_refused of a file: "));
  read(list_of(three.fleet.authority, 4, {}));
  CHECK(three.ant.count("news.lists") == 2);
}

TEST_CASE("a list tells a clock that is behind what time it is at least") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .clock_off = -hours(24 * 300)});
  RevocationList list;
  list.fleet = {fleet.authority.fleet.id()};
  list.number = 1;
  list.issued = kStartUtc + 3'600'000'000'000;
  const SignedRecord record =
      sign(kSignedRevocations, "", fleet.authority.fleet.id(), encode(list), fleet.authority.key);
  Effects effects;
  REQUIRE(ant.core->updates().on_update({record, {}}, 0, fleet.now_of(ant), effects).ok());
  fleet.carry_out(ant, effects);
  REQUIRE_FALSE(ant.stored_utc.empty());
  CHECK(ant.stored_utc.back() == UtcTime{list.issued});
}

TEST_CASE("a list without this node's beacon key is told in the log, but not of one that is out, nor without a list") {
  Three three;
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(three.renewed("dog", 3))}}).ok());
  CHECK_FALSE(logged(three.ant, "no_beacon_key"));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 1, {"cat"}, {"ant"}), {}}).ok());
  three.fleet.run(milliseconds(100));
  CHECK_FALSE(logged(three.ant, "no_beacon_key"));
  CHECK(three.ant.stored_news.back().beacon_box == Bytes(80, 'b'));
  CHECK(logged(three.bee, "no_beacon_key"));
  CHECK(three.bee.stored_news.back().beacon_box.empty());
  REQUIRE(logged(three.cat, "own_certificate_over"));
  CHECK_FALSE(logged(three.cat, "no_beacon_key"));
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
  CHECK(three.ant.stored_news.back().news.certificates.size() == 1);
  // For this node itself there are no other keys than those it has.
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
    ant.stored_news.clear();
    fleet.carry_out(ant, effects);
    return taken ? Errc::ok : taken.error().code;
  };
  std::size_t taken = 0;
  for (std::size_t i = 0; i < kMaxPeers; ++i) taken += tell("n" + std::to_string(i), 2) == Errc::ok ? 1 : 0;
  CHECK(taken == kMaxPeers);
  CHECK(ant.stored_news.back().news.certificates.size() == 256);
  CHECK(tell("one-more", 2) == Errc::queue_full);
  CHECK(tell("n7", 3) == Errc::ok);
}

TEST_CASE("news that are too much for one message go in several: the list first, then the certificates") {
  Three three;
  FleetNews all{list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {}};
  for (std::size_t i = 0; i < 200; ++i) {
    const Certificate one = of_another(three.fleet, "n" + std::to_string(i), 2);
    all.certificates.push_back(sign_long(three.fleet.authority, one, 3000));
  }
  SUBCASE("with a list") {}
  SUBCASE("without one") {
    all.revocations = {};
  }
  REQUIRE(encode(all).size() > kMaxUpdate);
  Heard heard(three.fleet, "ant", three.ant, "bee");
  REQUIRE(three.tell(three.ant, all).ok());
  three.fleet.run(2 * kStep);
  const std::size_t lists = all.revocations.kind.empty() ? 0 : 1;
  REQUIRE(heard.news.size() == lists + 3);
  if (lists == 1) {
    CHECK(heard.news[0].revocations == all.revocations);
    CHECK(heard.news[0].certificates.empty());
  }
  std::vector<SignedRecord> certificates;
  for (std::size_t i = lists; i < heard.news.size(); ++i) {
    CHECK(heard.news[i].revocations.kind.empty());
    CHECK_FALSE(heard.news[i].certificates.empty());
    CHECK(encode(heard.news[i]).size() <= kMaxUpdate);
    certificates.insert(certificates.end(), heard.news[i].certificates.begin(), heard.news[i].certificates.end());
  }
  CHECK(certificates == all.certificates);
  CHECK(three.bee.count("news.certificates") == 200);
}

TEST_CASE("who links again is told what it does not know, and no renewal that its node has shown itself") {
  Three three;
  three.fleet.stop("cat");
  three.fleet.stop("bee");
  const SignedRecord renewed = three.sign_certificate(three.renewed("cat", 5));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 1, {"dog"}, {"ant", "bee", "cat"}), {renewed}}).ok());
  CHECK(three.ant.stored_news.back().news.certificates.size() == 1);
  TestNode& bee = three.fleet.start("bee", {.boot = 2});
  three.fleet.run(Seconds(4));
  CHECK(bee.count("news.lists") == 1);
  CHECK(bee.count("news.certificates") == 1);
  three.fleet.start("cat", {.boot = 2});
  three.fleet.run(Seconds(4));
  REQUIRE(three.ant.link_to("cat") != 0);
  REQUIRE(three.ant.link_to("bee") != 0);
  // All know all by now.
  std::size_t told = 0;
  three.fleet.meddle = [&](const std::string&, LinkId, std::uint64_t&, Message& message) {
    told += message.subtype == FleetNews::kSubtype ? 1 : 0;
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

TEST_CASE("news over their size are not read; the log names who brought what was refused") {
  Three three;
  const auto bring = [&](std::size_t size) {
    const LinkId link = three.ant.link_to("bee");
    Message message = make_message(MessageType::information, "bee", "ant", FleetNews{});
    message.data = Bytes(size, '\xc1');
    three.fleet.arrive(three.ant, link, three.ant.core->table().link(link)->heard + 1, message);
  };
  bring(kMaxUpdate);
  CHECK(three.ant.count("refused.malformed") == 1);
  CHECK(logged(three.ant, "news_refused of bee: "));
  bring(kMaxUpdate + 1);
  CHECK(three.ant.count("refused.too_large") == 1);
}

TEST_CASE("who was dialled and has not said Hello may bring news, and is named as what it is") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false});
  fleet.withhold = [](const std::string& from, const Message&) { return from == "bee"; };
  fleet.run(2 * kStep);
  REQUIRE_FALSE(ant.dials.empty());
  SignedRecord forged = list_of(fleet.authority, 1, {"dog"});
  forged.signature.bytes[5] ^= 1;
  fleet.arrive(ant, ant.dials.back().link, 1, make_message(MessageType::information, "bee", "", FleetNews{forged, {}}));
  CHECK(ant.count("refused.bad_signature") == 1);
  CHECK(logged(ant, "news_refused of the node that was dialled: "));
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
                       [](const RefuseCandidate& one) { return one.message.subtype == FleetNews::kSubtype; });
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
    CHECK(decode<FleetNews>(ant.refused.front().message.data)->certificates == std::vector{cat.record});
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
