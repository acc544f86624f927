// Revocation lists: who is revoked, and what happens to a revoked node. Time is injected, nothing sleeps.
#include "services/router/test/test_trust.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;

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
    if (std::holds_alternative<StoreUpdate>(effects.list[i])) stored = i;
    if (std::holds_alternative<LinkSend>(effects.list[i]) || std::holds_alternative<CloseLink>(effects.list[i])) {
      CHECK(stored.has_value());
    }
  }
  REQUIRE(stored);
  const auto& store = std::get<StoreUpdate>(effects.list[*stored]);
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

TEST_CASE("services hear that a node is revoked which has been silent for long") {
  Three three;
  TestNode& ant = three.ant;
  Effects effects;
  ant.core->bus().on_hello(1, {"resilience", {"peer_expired"}, 1, 1, "1"}, "resilience", three.fleet.now, effects);
  three.fleet.stop("cat");
  three.fleet.run(Seconds(30));
  REQUIRE(ant.told("peer_expired") == 1);
  REQUIRE(three.tell(ant, {list_of(three.fleet.authority, 1, {"cat"}), {}}).ok());
  CHECK(ant.told("peer_expired") == 2);
}

TEST_CASE("a service hears who is revoked at its welcome and at each list, met or not, but for who is a member again") {
  Three three;
  TestNode& ant = three.ant;
  const auto last_told = [&] {
    std::string out;
    for (const BusSend& send : ant.bus) {
      if (send.message.subtype != RevokedNodes::kSubtype) continue;
      out.clear();
      const auto body = decode<RevokedNodes>(send.message.data);
      for (const RevokedNode& one : body->nodes) out += one.id + " " + std::to_string(one.serial) + ";";
    }
    return out;
  };
  const auto welcome = [&](ConnectionId as, const char* service, std::vector<std::string> hears) {
    Effects effects;
    ant.bus.clear();
    ant.core->bus().on_hello(as, {service, {}, 5, 100, "1", std::move(hears)}, service, three.fleet.now, effects);
    three.fleet.carry_out(ant, effects);
    return last_told();
  };
  CHECK(welcome(1, "scheduler", {"revoked_nodes"}).empty());
  REQUIRE(three.tell(ant, {list_of(three.fleet.authority, 1, {"cat", "dog"}), {}}).ok());
  CHECK(last_told() == "cat 1;dog 1;");
  CHECK(welcome(2, "resilience", {"peer_expired"}).empty());
  CHECK(welcome(1, "scheduler", {"revoked_nodes"}) == "cat 1;dog 1;");
  Certificate again = of_another(three.fleet, "dog", 2);
  again.not_after = kStartUtc + std::chrono::nanoseconds(hours(24 * 300)).count();
  REQUIRE(three.tell(ant, {{}, {three.sign_certificate(again)}}).ok());
  CHECK(welcome(1, "scheduler", {"revoked_nodes"}) == "cat 1;");
  REQUIRE(three.tell(ant, {list_of(three.fleet.authority, 2, {"cat", "eel"}), {}}).ok());
  CHECK(last_told() == "cat 1;eel 1;");
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
  CHECK(ant.refused.front().message.subtype == TrustUpdate::kSubtype);
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
                     make_message(MessageType::information, "bee", "ant", TrustUpdate{forged, {}}));
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

TEST_CASE("a list without this node's beacon key is told in the log, but not of one that is out, nor without a list") {
  Three three;
  REQUIRE(three.tell(three.ant, {{}, {three.sign_certificate(three.renewed("dog", 3))}}).ok());
  CHECK_FALSE(logged(three.ant, "no_beacon_key"));
  REQUIRE(three.tell(three.ant, {list_of(three.fleet.authority, 1, {"cat"}, {"ant"}), {}}).ok());
  three.fleet.run(milliseconds(100));
  CHECK_FALSE(logged(three.ant, "no_beacon_key"));
  CHECK(three.ant.stored_updates.back().beacon_box == Bytes(80, 'b'));
  CHECK(logged(three.bee, "no_beacon_key"));
  CHECK(three.bee.stored_updates.back().beacon_box.empty());
  REQUIRE(logged(three.cat, "own_certificate_over"));
  CHECK_FALSE(logged(three.cat, "no_beacon_key"));
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

namespace {

/// A list that revokes cat until `until`; with it or without.
SignedRecord list_with_end(const TestAuthority& authority, std::uint64_t number, std::optional<std::int64_t> until) {
  RevocationList list;
  list.number = number;
  list.beacon_number = static_cast<std::uint32_t>(number + 1);
  if (until) list.revoked.push_back({1, "cat", "stolen", kStartUtc, *until});
  return sign_list(authority, list);
}

}  // namespace

TEST_CASE("a list that lacks who is revoked and has not ended is in force, and does not let that node in again") {
  Three three;
  const std::int64_t end = kStartUtc + std::chrono::nanoseconds(hours(24)).count();
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 1, end), {}}).ok());
  CHECK(three.ant.count("news.dropped") == 0);
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 2, std::nullopt), {}}).ok());
  three.fleet.run(Seconds(20));
  CHECK(three.ant.peer("cat") == nullptr);
  CHECK(three.bee.peer("cat") == nullptr);
  CHECK(three.ant.count("news.dropped") == 1);
  CHECK(logged(three.ant, "revocations_dropped list 2 lacks 'cat' (serial 1), one of 1 that are revoked"));
  // What is stored and told to others is the list as it was signed.
  CHECK(three.ant.stored_updates.back().update.revocations == list_with_end(three.fleet.authority, 2, std::nullopt));
}

TEST_CASE("who has ended leaves with the list that lacks it") {
  Three three;
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 1, kStartUtc - 1), {}}).ok());
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 2, std::nullopt), {}}).ok());
  CHECK(three.ant.count("news.dropped") == 0);
  CHECK_FALSE(logged(three.ant, "revocations_dropped"));
}

TEST_CASE("who has ended nobody knows when stays out, whatever list lacks it") {
  Three three;
  three.fleet.stop("cat");  // it hears of no list
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 1, 0), {}}).ok());
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 2, std::nullopt), {}}).ok());
  REQUIRE(three.tell(three.ant, {list_with_end(three.fleet.authority, 3, std::nullopt), {}}).ok());
  three.fleet.start("cat", {.boot = 2});
  three.fleet.run(Seconds(20));
  CHECK(three.ant.peer("cat") == nullptr);
  CHECK(three.bee.peer("cat") == nullptr);
  // It may well have ended: an authority of an earlier version did not say.
  CHECK(three.ant.count("news.dropped") == 0);
  CHECK_FALSE(logged(three.ant, "revocations_dropped"));
}

TEST_CASE("a list that says of who is revoked no less drops nobody, whatever keys it names") {
  const std::int64_t end = kStartUtc + std::chrono::nanoseconds(hours(24)).count();
  const Revocation named{1, "cat", "stolen", kStartUtc, end, {Bytes(kRevokedKey, 'i')}, {Bytes(kRevokedKey, 'l')}};
  const Revocation unnamed{1, "cat", "stolen", kStartUtc};  // as an earlier version writes the list anew
  const Revocation later{9, "cat", "stolen", kStartUtc, end, {Bytes(kRevokedKey, 'j')}, {Bytes(kRevokedKey, 'm')}};
  for (const Revocation& next : {unnamed, later}) {
    Three three;
    std::uint64_t number = 0;
    for (const Revocation& entry : {named, next}) {
      RevocationList list;
      list.number = ++number;
      list.beacon_number = static_cast<std::uint32_t>(number + 1);
      list.revoked.push_back(entry);
      REQUIRE(three.tell(three.ant, {sign_list(three.fleet.authority, list), {}}).ok());
    }
    CHECK(three.ant.count("news.dropped") == 0);
    CHECK_FALSE(logged(three.ant, "revocations_dropped"));
    CHECK(three.ant.peer("cat") == nullptr);
  }
}
