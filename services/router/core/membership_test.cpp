// Who is revoked and comes back, and when a node is warned that its own certificate ends: one node, driven by hand.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;
using std::chrono::hours;
using std::chrono::minutes;

namespace {

constexpr Duration kDay = hours(24);

struct Ant {
  TestFleet fleet;
  TestNode& ant;
  const MonotonicTime start = fleet.now.mono;

  explicit Ant(const TestFleet::Options& options = {.beacon = false}, Duration valid = kDay * 300, Duration later = {})
      : ant(make(options, valid, later)) {}

  TestNode& make(const TestFleet::Options& options, Duration valid, Duration later) {
    TestKeys& keys = fleet.keys("ant");
    keys.certificate.not_after = kStartUtc + valid.count();
    keys.record = sign_certificate(keys.certificate);
    fleet.now.utc = fleet.now.utc + later;
    return fleet.start("ant", options);
  }
  SignedRecord sign_certificate(const Certificate& certificate) const {
    return sign(kSignedCertificate, "", fleet.authority.fleet.id(), encode(certificate), fleet.authority.key);
  }
  /// The UTC clock may run apart from the monotonic one.
  Effects tick(Duration mono, Duration utc) {
    fleet.now = {start + mono, UtcTime{kStartUtc} + utc};
    Effects effects;
    ant.core->tick(fleet.now, effects);
    fleet.carry_out(ant, effects);
    return effects;
  }
  Effects tick(Duration after) { return tick(after, after); }
  void say(LinkId link, const TestKeys& keys, const Message& message) {
    Effects effects;
    ant.core->inbox().on_message(link, keys.link.public_key, message, 1, fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  void greet(LinkId link, const TestKeys& keys) {
    const Hello hello{keys.record, 3, fleet.address(keys.certificate.id), "1", kStartUtc, true, {}, 0, "behind",
                      false,       ""};
    say(link, keys, make_message(MessageType::information, keys.certificate.id, "", hello));
  }
  void beacon(const TestKeys& keys) {
    const std::string& id = keys.certificate.id;
    const Beacon body{keys.record, fleet.address(id), 3, kStartUtc, 1};
    Effects effects;
    ant.core->beacons().on_beacon(
        encode(sign(kSignedBeacon, id, fleet.authority.fleet.id(), encode(body), keys.identity)), fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  /// The list says that they have ended, so that the next one may lack them.
  void revoke(std::uint64_t number, const std::vector<std::string>& ids, std::uint64_t serial = 1,
              std::int64_t issued = kStartUtc) {
    RevocationList list;
    list.fleet = {fleet.authority.fleet.id()};
    list.number = number;
    list.issued = issued;
    for (const std::string& id : ids) list.revoked.push_back({serial, id, "stolen", kStartUtc, kStartUtc});
    Effects effects;
    REQUIRE(ant.core->updates()
                .on_update(
                    {sign(kSignedRevocations, "", fleet.authority.fleet.id(), encode(list), fleet.authority.key), {}},
                    0, fleet.now, effects)
                .ok());
    fleet.carry_out(ant, effects);
  }
  bool admit(const TestKeys& keys) {
    Effects effects;
    const bool good = ant.core->admission().admit(keys.link.public_key, fleet.now, effects);
    fleet.carry_out(ant, effects);
    return good;
  }
  /// What `trb doctor` reads of a peer's errors.
  std::string row(const std::string& peer, const std::string& code) {
    Effects effects;
    ant.core->bus().on_hello(7, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
    ant.core->forwarding().on_bus_message(7, make_message(MessageType::request, "ant", "ant", LinkErrorTableRequest{}),
                                          fleet.now, effects);
    const auto table = decode<LinkErrorTable>(std::get<BusSend>(effects.list.back()).message.data);
    for (const LinkErrorRow& row : table->errors) {
      if (row.peer == peer && row.code == code) return row.text;
    }
    return "none";
  }
  [[nodiscard]] std::size_t told(const std::string& text) const {
    return static_cast<std::size_t>(std::count_if(
        ant.log.begin(), ant.log.end(), [&](const std::string& line) { return line.find(text) != std::string::npos; }));
  }
  std::size_t dials_to(const std::string& id) {
    return static_cast<std::size_t>(std::count_if(ant.dials.begin(), ant.dials.end(), [&](const Dial& dial) {
      return dial.server_key == fleet.keys(id).link.public_key;
    }));
  }
};

}  // namespace

TEST_CASE("a revoked node that was never met is known by its key from its first Hello on, and answered no more") {
  Ant one;
  const TestKeys dog = one.fleet.keys("dog");
  one.revoke(1, {"dog"});
  one.greet(9, dog);
  CHECK(one.ant.count("refused.cert_revoked") == 1);
  CHECK(one.row("dog", "cert_revoked").find("is revoked by list 1: stolen") != std::string::npos);
  one.ant.refused.clear();
  CHECK_FALSE(one.admit(dog));
  CHECK(one.ant.count("refused.cert_revoked") == 2);
  CHECK(one.row("dog", "cert_revoked") == "its key has knocked since: stolen");
  one.say(10, dog, make_message(MessageType::information, "dog", "", KeepAlive{1}));
  CHECK(one.ant.count("refused.cert_revoked") == 3);
  CHECK(one.told("revoked_key the revoked key of 'dog' knocked") == 2);
  CHECK(one.ant.refused.empty());
}

TEST_CASE("who presents a revoked certificate with other keys shuts out nobody but himself") {
  Ant one;
  const TestKeys dog = one.fleet.keys("dog");
  TestKeys thief = one.fleet.keys("cat");
  one.revoke(1, {"dog"});
  thief.record = dog.record;
  thief.certificate.id = "dog";
  one.greet(9, thief);
  CHECK(one.ant.count("refused.cert_revoked") == 1);
  one.admit(dog);
  CHECK(one.ant.count("refused.cert_revoked") == 1);
}

TEST_CASE("who is on the next list too stays out; who is no longer on it is a stranger that may come back") {
  Ant one;
  const TestKeys cat = one.fleet.keys("cat");
  one.greet(9, cat);
  one.revoke(1, {"cat"});
  REQUIRE(one.ant.peer("cat") == nullptr);
  one.revoke(2, {"cat", "eel"});
  CHECK_FALSE(one.admit(cat));
  CHECK(one.ant.count("refused.cert_revoked") == 2);
  one.revoke(3, {"eel"});
  CHECK(one.admit(cat));
  CHECK(one.ant.count("candidates") == 1);
  one.greet(10, cat);
  CHECK(one.ant.link_to("cat") == 10);
}

TEST_CASE("the keys of 1024 revoked nodes are remembered") {
  Ant one;
  std::vector<TestKeys> out;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i <= kMaxPeers; ++i) {
    ids.push_back("n" + std::to_string(i));
    out.push_back(one.fleet.authority.sign_node(ids.back()));
  }
  one.revoke(1, ids);
  for (const TestKeys& keys : out) one.greet(random_u64(), keys);
  one.tick(Seconds(11));  // no key is denied for an earlier refusal any more
  const std::uint64_t before = one.ant.count("refused.cert_revoked");
  CHECK_FALSE(one.admit(out[kMaxPeers - 1]));
  CHECK(one.ant.count("refused.cert_revoked") == before + 1);
  CHECK(one.admit(out[kMaxPeers]));
}

TEST_CASE("who is revoked while it is dialled is dialled no more, and whoever else is linked or dialled stays so") {
  Ant one({.beacon = false, .seeds = {"bee", "cat", "dog"}});
  for (const char* id : {"bee", "cat", "dog"}) {
    one.fleet.start(id, {.beacon = false});
    one.fleet.cut("ant", id);
  }
  one.greet(9, one.fleet.keys("bee"));
  one.beacon(one.fleet.keys("cat"));
  one.tick({});
  CHECK(one.dials_to("bee") == 0);
  REQUIRE(one.dials_to("cat") == 1);
  REQUIRE(one.dials_to("dog") == 1);
  LinkId cat = 0;
  LinkId dog = 0;
  for (const Dial& dial : one.ant.dials)
    (dial.server_key == one.fleet.keys("cat").link.public_key ? cat : dog) = dial.link;
  one.revoke(1, {"cat"});
  CHECK(one.ant.core->table().link(cat) == nullptr);
  CHECK(one.told("dial_ended unproven: cert_revoked: stolen") == 1);
  CHECK(one.ant.core->table().link(dog) != nullptr);
  CHECK(one.ant.link_to("bee") == 9);
  // It was never linked, so no service is notified that it is gone.
  CHECK(one.ant.count("peer_expired") == 0);
  CHECK(one.row("cat", "cert_revoked") == "by list 1: stolen");
  one.tick(Seconds(3));
  one.tick(Seconds(6));
  CHECK(one.dials_to("cat") == 1);
  CHECK(one.dials_to("bee") == 0);
}

TEST_CASE("of who is revoked after its lease has ended services hear that, too; it is counted once") {
  Ant one;
  one.greet(9, one.fleet.keys("bee"));
  one.tick(Seconds(10));
  REQUIRE(one.ant.count("peer_expired") == 1);
  one.revoke(1, {"bee"});
  CHECK(one.ant.peer("bee") == nullptr);
  CHECK(one.ant.count("peer_expired") == 1);
  CHECK(one.told("peer_expired bee: cert_revoked: stolen") == 1);
}

TEST_CASE("a stranger that was let in, is then known by its beacon and revoked is none that said nothing") {
  Ant one;
  const TestKeys bee = one.fleet.keys("bee");
  CHECK(one.admit(bee));
  one.beacon(bee);
  one.revoke(1, {"bee"});
  one.tick(Seconds(3));
  CHECK(one.ant.count("refused.no_hello") == 0);
}

TEST_CASE("the renewal of a node that is then revoked is told to nobody") {
  Ant one;
  Certificate renewed = one.fleet.keys("dog").certificate;
  renewed.serial = 4;
  Effects effects;
  REQUIRE(one.ant.core->updates().on_update({{}, {one.sign_certificate(renewed)}}, 0, one.fleet.now, effects).ok());
  one.fleet.carry_out(one.ant, effects);
  REQUIRE(one.ant.stored_updates.back().update.certificates.size() == 1);
  one.revoke(1, {"dog"}, 3);
  CHECK(one.ant.stored_updates.back().update.certificates.size() == 1);
  one.revoke(2, {"dog"}, 4);
  one.revoke(3, {"dog"}, 5);  // what is stored follows what is known
  CHECK(one.ant.stored_updates.back().update.certificates.empty());
}

TEST_CASE("the end of a certificate is told from thirty days before it on, to the moment") {
  CHECK(Ant({.beacon = false}, kDay * 30).told("certificate_ends") == 1);
  CHECK(Ant({.beacon = false}, kDay * 30 + kInstant).told("certificate_ends") == 0);
}

TEST_CASE("the end of a certificate is told once a day, also if it was told while the clock was a day ahead") {
  Ant one({.beacon = false}, kDay * 25, kDay * 10);
  REQUIRE(one.told("certificate_ends") == 1);
  SUBCASE("a day later") {
    one.tick(kDay - kInstant, kDay * 11 - kInstant);
    CHECK(one.told("certificate_ends") == 1);
    one.tick(kDay, kDay * 11);
    CHECK(one.told("certificate_ends") == 2);
  }
  SUBCASE("set right by a day") {
    one.tick(Seconds(1), kDay * 9 + kInstant);
    CHECK(one.told("certificate_ends") == 1);
    one.tick(Seconds(2), kDay * 9);
    CHECK(one.told("certificate_ends") == 2);
  }
}

TEST_CASE(
    "a node whose clock jumps past its end says goodbye to all; when it is back it dials all at once, untroubled") {
  for (const bool beacon : {true, false}) {
    CAPTURE(beacon);
    Ant one({.beacon = beacon, .seeds = {"dog"}}, kDay * 300);
    TestKeys& bee = one.fleet.keys("bee");
    bee.certificate.not_after = kStartUtc + (kDay * 900).count();
    bee.record = one.sign_certificate(bee.certificate);
    one.tick({});
    one.greet(9, bee);
    const auto goodbye = [](const Effects& effects) {
      return std::any_of(effects.list.begin(), effects.list.end(), [](const Effect& effect) {
        const auto* send = std::get_if<LinkSend>(&effect);
        return send != nullptr && send->message.subtype == Goodbye::kSubtype;
      });
    };
    CHECK(goodbye(one.tick(Seconds(1), kDay * 301)));
    CHECK(one.ant.link_to("bee") == 0);
    CHECK(one.row("ant", "own.cert_expired") != "none");
    CHECK(one.ant.core->next_deadline() <= one.start + Seconds(3));
    one.ant.beacons.clear();
    const std::size_t to_bee = one.dials_to("bee");
    const std::size_t to_dog = one.dials_to("dog");
    one.tick(Seconds(2), kDay * 301);
    CHECK(one.dials_to("bee") + one.dials_to("dog") == to_bee + to_dog);
    CHECK(one.ant.beacons.empty());
    one.tick(Seconds(2) + milliseconds(10), Seconds(2));
    CHECK(one.dials_to("bee") == to_bee + 1);
    CHECK(one.dials_to("dog") == to_dog + 1);
    CHECK(one.ant.beacons.size() == (beacon ? 1 : 0));
    CHECK(one.row("ant", "own.cert_expired") == "none");
  }
}

TEST_CASE("that it is later than a clock says is stored once for each time that the authority has told") {
  Ant one({.beacon = false, .clock_off = -kDay * 300});
  const std::int64_t issued = kStartUtc + 3'600'000'000'000;
  one.fleet.now.utc = UtcTime{kStartUtc} - kDay * 300;
  one.revoke(1, {"dog"}, 1, issued);
  one.revoke(2, {"dog", "eel"}, 1, issued);
  CHECK(one.ant.stored_utc == std::vector<UtcTime>{{issued}});
  one.revoke(3, {"dog"}, 1, issued + 1);
  CHECK(one.ant.stored_utc == std::vector<UtcTime>{{issued}, {issued + 1}});
}

TEST_CASE("at the moment at which a node's certificate has ended its clock is not believed any more") {
  for (const bool ends : {true, false}) {
    CAPTURE(ends);
    Ant one({.beacon = false}, minutes(20) + (ends ? Duration{} : kInstant));
    one.tick({});
    one.tick(minutes(10));
    CHECK(one.ant.stored_utc.size() == 1);
    one.tick(minutes(20));
    CHECK(one.ant.stored_utc.size() == (ends ? 1 : 2));
  }
}

TEST_CASE(
    "a clock that is behind what the certificate says is not stored, and a peer's that is unsure counts for nothing") {
  Ant one;
  one.tick({}, -Duration(hours(1)));
  one.tick(minutes(10), minutes(10) - hours(1));
  CHECK(one.ant.stored_utc.empty());
  Ant other;
  const TestKeys bee = other.fleet.keys("bee");
  const Hello unsure{bee.record, 3, "10.0.0.2:45000", "1", 0, false, {}, 0, "behind", false, ""};
  other.tick({});
  other.say(9, bee, make_message(MessageType::information, "bee", "", unsure));
  REQUIRE(other.ant.link_to("bee") == 9);
  other.tick(minutes(10));
  CHECK(other.ant.stored_utc.size() == 1);
}

TEST_CASE("a renewal that has ended is forgotten when somebody joins, once the clock has run in step for long") {
  Ant one;
  Certificate brief = one.fleet.keys("dog").certificate;
  brief.serial = 4;
  brief.not_after = kStartUtc + Duration(minutes(11)).count();
  Effects effects;
  REQUIRE(one.ant.core->updates().on_update({{}, {one.sign_certificate(brief)}}, 0, one.fleet.now, effects).ok());
  for (const int minute : {5, 12}) {
    CAPTURE(minute);
    one.tick(minutes(minute));
    one.greet(static_cast<LinkId>(minute), one.fleet.keys("bee"));
    one.revoke(static_cast<std::uint64_t>(minute), {"eel"});
    CHECK(one.ant.stored_updates.back().update.certificates.size() == (minute == 5 ? 1 : 0));
  }
}

TEST_CASE("a node that cannot read who is revoked lets nobody in and dials nobody, says why, and takes nothing over") {
  Ant one({.seeds = {"cat"}, .updates_lost = fail(Errc::malformed, "state/news: is damaged", "rm it")});
  const TestKeys cat = one.fleet.keys("cat");
  one.tick(minutes(1));
  CHECK(one.dials_to("cat") == 0);
  CHECK(one.ant.beacons.empty());
  CHECK_FALSE(one.admit(cat));
  CHECK(one.ant.count("refused.revocations_unknown") == 1);
  CHECK(one.row("ant", "own.revocations_unknown").find("state/news: is damaged") != std::string::npos);
  CHECK(one.told("state/news: is damaged; rm it") == 1);
  // An older list would take the place of what may still be mended.
  Effects effects;
  const auto taken = one.ant.core->updates().on_update({}, 0, one.fleet.now, effects);
  REQUIRE_FALSE(taken.ok());
  CHECK(taken.error().what == "what was signed before is not known: state/news: is damaged");
  one.ant.core->updates().on_brought("keys/news.json", TrustUpdate{}, one.fleet.now, effects);
  CHECK(one.ant.stored_updates.empty());
  CHECK(one.ant.core->updates().note().empty());
}
