// Revocation lists: their entries, how long these stay, and how large a list may grow; and the news.json that carries
// it.
#include <limits>

#include "common/security/ever_revoked.hpp"
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

Certificate made_for(const Hall& hall, const std::string& id, std::uint64_t serial) {
  return {{hall.authority.fleet.id()},
          serial,
          id,
          Role::robot,
          {Bytes(32, 'i')},
          {Bytes(32, 'l')},
          kNow.ns,
          (kNow + kYear).ns};
}

}  // namespace

TEST_CASE("an entry stays until a certificate that it covers is taken by no clock that is up to 30 days behind") {
  Hall hall;
  hall.join("ur3");
  const Certificate first = hall.living("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  const UtcTime end = UtcTime{first.not_after} + kEndLeeway;
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", {end.ns - 1}).ok());
  CHECK(hall.authority.list.revoked.size() == 1);
  // Its successor has the same name: that is no reason to keep it.
  REQUIRE(sign_request(hall.authority, hall.dir, hall.request("new-pc", "ur3"), kNow, 2 * kYear).ok());
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", end).ok());
  CHECK(hall.authority.list.revoked.empty());
  CHECK(hall.authority.list.issued == end.ns);
}

TEST_CASE("an entry says until when its certificates are valid, and which keys were revoked") {
  Hall hall;
  REQUIRE(sign_request(hall.authority, hall.dir, hall.request("ur3", "ur3"), kNow, 3 * kYear).ok());
  const std::int64_t longest = hall.living("ur3").not_after;
  hall.join("ur3");  // a newer one that ends earlier
  const Certificate named = hall.living("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  const Revocation entry = open_revocations(hall.authority.revocations, hall.authority.fleet)->revoked.front();
  CHECK(entry.until == longest);
  CHECK(entry.identity.bytes == named.identity_key.bytes.substr(0, kRevokedKey));
  CHECK(entry.link.bytes == named.link_key.bytes.substr(0, kRevokedKey));
}

TEST_CASE("who is revoked after its end is in the list that says so, and is never renewed or signed again") {
  Hall hall;
  hall.join("ur3");
  hall.join("ur5");
  const Certificate ended = hall.living("ur3");
  const UtcTime later = kNow + 2 * kYear;
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {ended}, "stolen", later).ok());
  CHECK(find_revocation(hall.authority.list, ended) != nullptr);
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", later).ok());
  CHECK(hall.authority.list.revoked.empty());
  // Ever: also for who reads the folder anew.
  const UtcTime ever{std::numeric_limits<std::int64_t>::min()};
  Authority stored = *hall.read();
  CHECK(find_living(stored, "ur3", ever) == nullptr);
  CHECK(find_living(stored, "ur5", ever) != nullptr);
  CHECK(code_of(sign_request(stored, hall.dir, hall.request("ur3", "ur3"), later, kYear)) == Errc::cert_revoked);
}

TEST_CASE("what a wrong clock has dropped from a list is in the next one again") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  REQUIRE(hall.revoke("ur3").ok());
  const Certificate ur5 = hall.living("ur5");
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {ur5}, "sold", kNow + 2 * kYear).ok());
  CHECK(hall.authority.list.revoked.size() == 1);
  REQUIRE(missing_from_list(*hall.read(), kNow).size() == 1);
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", kNow).ok());
  CHECK(hall.authority.list.revoked.size() == 2);
  CHECK(missing_from_list(*hall.read(), kNow).empty());
}

TEST_CASE("a name that was revoked twice, with other keys, keeps both keys from being signed") {
  Hall hall;
  hall.join("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  REQUIRE(sign_request(hall.authority, hall.dir, hall.request("second", "ur3"), kNow, kYear).ok());
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(hall.authority.list.revoked.size() == 2);
  // Also in a folder that has none of the certificates.
  hall.authority.issued.clear();
  for (const char* node : {"ur3", "second"}) CHECK(code_of(hall.ask(node, "ur3")) == Errc::cert_revoked);
}

TEST_CASE("a damaged revoked.json is told, never taken for nobody") {
  Hall hall;
  const std::string path = hall.dir + "/revoked.json";
  for (const char* text :
       {"{", "{}", R"({"revoked":[1]})", R"({"revoked":[{"id":"ur3"}]})",
        R"({"revoked":[{"id":"a","serial":1,"reason":"","at":1,"until":1,"identity":"zz","link":""}]})"}) {
    REQUIRE(write_file(path, text).ok());
    const auto read = hall.read();
    REQUIRE(code_of(read) == Errc::malformed);
    CHECK(read.error().what.find(path) == 0);
  }
}

TEST_CASE("who is revoked again stands there once, with what was said last") {
  Hall hall;
  hall.join("ur3");
  const Certificate first = hall.living("ur3");
  hall.join("ur3");
  const Certificate second = hall.living("ur3");
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {second}, "lost", kNow).ok());
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {second}, "stolen", kNow + Duration(5)).ok());
  const Revocation row{2,
                       "ur3",
                       "stolen",
                       kNow.ns + 5,
                       second.not_after,
                       {second.identity_key.bytes.substr(0, kRevokedKey)},
                       {second.link_key.bytes.substr(0, kRevokedKey)}};
  CHECK(hall.authority.list.revoked == std::vector{row});
  // The older one was covered already.
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {first}, "sold", kNow).ok());
  CHECK(hall.authority.list.revoked == std::vector{row});
}

TEST_CASE("an entry is of one name: the same serial of another node is not revoked by it") {
  const RevocationList list{{}, 1, 0, {{5, "ur3", "stolen", 0}}, 2, {}};
  const Hall hall;
  CHECK(find_revocation(list, made_for(hall, "ur3", 5)) == &list.revoked.front());
  CHECK(find_revocation(list, made_for(hall, "ur3", 4)) != nullptr);
  CHECK(find_revocation(list, made_for(hall, "ur3", 6)) == nullptr);
  CHECK(find_revocation(list, made_for(hall, "ur5", 4)) == nullptr);
}

TEST_CASE("a list of another fleet, changed, or of other bytes, opens for nobody") {
  Hall hall;
  hall.join("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  SignedRecord record = hall.authority.revocations;
  CHECK(open_revocations(record, hall.authority.fleet).ok());
  SignedRecord renamed = record;
  renamed.kind = kSignedCertificate;
  CHECK(code_of(open_revocations(renamed, hall.authority.fleet)) == Errc::bad_signature);
  record.payload.bytes = "no list";
  CHECK_FALSE(open_revocations(record, hall.authority.fleet).ok());
}

namespace {

/// Fills the authority's list with the largest entries that a certificate allows, revoked long ago.
struct LongList : Hall {
  std::vector<Revocation>& rows = authority.list.revoked;

  LongList() {
    join("ur5");
    authority.issued.push_back(made_for(*this, name, 256));
  }
  void add(std::size_t count, const std::string& reason) {
    for (std::size_t i = 0; i < count; ++i) rows.push_back({256 + rows.size(), name, reason, kNow.ns});
  }
  Status next() { return revoke_certificates(authority, dir, {}, "", kNow); }
  [[nodiscard]] std::size_t size() const { return encode(authority.list).size(); }
  /// Another list is refused, and the previous one stays in force.
  void is_refused() {
    const Authority before = authority;
    REQUIRE(code_of(next()) == Errc::too_large);
    CHECK(authority.list == before.list);
    CHECK(authority.revocations == before.revocations);
    CHECK(authority.beacon.number == before.beacon.number);
    CHECK(read()->revocations == before.revocations);
  }

 private:
  const std::string name = std::string(64, 'x');
};

}  // namespace

TEST_CASE("a list of 400 kB is made, and of one byte more it is not") {
  LongList hall;
  const std::string reason(128, 'r');
  hall.add(20, reason);
  REQUIRE(hall.next().ok());
  const std::size_t before = hall.size();
  hall.add(1, reason);
  const std::size_t row = hall.size() - before;
  hall.add((400'000 - before) / row, reason);
  const std::size_t over = hall.size() - 400'000;
  for (std::size_t i = 0; i < over; ++i) hall.rows[i].reason.pop_back();
  REQUIRE(hall.next().ok());
  CHECK(hall.authority.revocations.payload.bytes.size() == 400'000);
  CHECK(hall.read()->list == hall.authority.list);
  hall.rows[0].reason.resize(128, 'r');
  hall.is_refused();
}

TEST_CASE("a list with more entries than a node takes is not signed: the authority could not read it itself") {
  LongList hall;
  hall.add(2000, "");
  REQUIRE(hall.next().ok());
  CHECK(hall.read()->list.revoked.size() == 2000);
  hall.add(1, "");
  hall.is_refused();
}

TEST_CASE("the news hold each living certificate once, and none that is revoked, replaced or forged") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  const auto renew = [&](const std::string& id) {
    return renew_certificates(hall.authority, hall.dir, {hall.living(id)}, kNow, kYear)->front();
  };
  const auto told = [&](const std::vector<SignedRecord>& renewed) {
    REQUIRE(publish_trust_updates(hall.authority, hall.dir, renewed, kNow).ok());
    return read_trust_updates(hall.dir + "/news.json")->certificates;
  };
  const SignedRecord older = renew("ur3");
  CHECK(told({older}) == std::vector{older});
  CHECK(told({older}) == std::vector{older});
  const SignedRecord newer = renew("ur3");
  const SignedRecord cloud = renew("cloud");
  SignedRecord forged = cloud;
  forged.signature.bytes[0] ^= 1;
  CHECK(told({forged, newer, cloud}) == std::vector{newer, cloud});
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(told({}) == std::vector{cloud});
}

TEST_CASE("news carry 256 renewals; of older ones as many as have room beside the new") {
  Hall hall;
  std::vector<SignedRecord> renewed;
  for (std::uint64_t serial = 1; serial <= 257; ++serial) {
    hall.authority.issued.push_back(made_for(hall, "ur" + std::to_string(serial), serial));
    renewed.push_back(hall.sign_certificate(hall.authority.issued.back()));
  }
  const auto told = [&] { return read_trust_updates(hall.dir + "/news.json")->certificates; };
  CHECK(code_of(publish_trust_updates(hall.authority, hall.dir, renewed, kNow)) == Errc::too_large);
  CHECK_FALSE(file_exists(hall.dir + "/news.json"));
  const SignedRecord last = renewed.back();
  renewed.pop_back();
  REQUIRE(publish_trust_updates(hall.authority, hall.dir, renewed, kNow).ok());
  CHECK(told() == renewed);
  REQUIRE(publish_trust_updates(hall.authority, hall.dir, {last}, kNow).ok());
  CHECK(told().size() == 256);
  CHECK(told().front() == last);
  CHECK(told()[1] == renewed.front());
}

TEST_CASE("news may be read by whoever gets them: they are carried to a node as another user") {
  Hall hall;
  REQUIRE(publish_trust_updates(hall.authority, hall.dir, {}, kNow).ok());
  CHECK((std::filesystem::status(hall.dir + "/news.json").permissions()) == std::filesystem::perms(0644));
}

TEST_CASE("news that are not there, or damaged, are told with their path") {
  const Hall hall;
  const std::string path = hall.dir + "/news.json";
  CHECK(code_of(read_trust_updates(path)) == Errc::missing);
  REQUIRE(write_file(path, "{").ok());
  CHECK(code_of(read_trust_updates(path)) == Errc::malformed);
  CHECK(read_trust_updates(path).error().what.find(path) == 0);
}
