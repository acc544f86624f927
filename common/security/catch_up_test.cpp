// A folder restored from a copy learns what the fleet knows.
#include "common/security/ever_revoked.hpp"
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// The same authority twice: as it went on, and as restored from an earlier copy of the folder.
struct Restored : Hall {
  std::string copy_dir = root + "/copy";
  Authority copy;

  Restored() {
    for (const char* id : {"ur3", "ur5", "cloud"}) join(id);
  }
  void put_back() {
    std::filesystem::copy(dir, copy_dir);
    copy = authority;
  }
  Status revoke_in_copy(const std::string& id, const std::string& reason) {
    return revoke_certificates(copy, copy_dir, {*find_living(copy, id, kNow)}, reason, kNow);
  }
  Result<bool> hear(const std::vector<SignedRecord>& certificates = {}) {
    return catch_up(copy, copy_dir, {authority.revocations, certificates});
  }
  SignedRecord renew(const std::string& id) {
    return renew_certificates(authority, dir, {living(id)}, kNow, kYear)->front();
  }
};

}  // namespace

TEST_CASE("certificates alone are news too, and are kept, oldest first") {
  Restored hall;
  hall.put_back();
  const SignedRecord first = hall.renew("ur3");
  const SignedRecord second = hall.renew("ur5");
  const auto learned = hall.hear({second, first, second});
  REQUIRE(learned.ok());
  CHECK(*learned);
  CHECK(hall.copy.issued == hall.authority.issued);
  CHECK(hall.copy.next_serial > hall.authority.next_serial);
  CHECK(read_authority(hall.copy_dir)->issued == hall.authority.issued);
  CHECK_FALSE(*hall.hear({first, second}));
  CHECK_FALSE(*hall.hear());
  CHECK(hall.copy.revocations.kind.empty());
}

TEST_CASE("a newer list is in force at once, on disk too, with its beacon key") {
  Restored hall;
  hall.put_back();
  REQUIRE(hall.revoke("ur3").ok());
  const auto learned = hall.hear();
  REQUIRE(learned.ok());
  CHECK(*learned);
  CHECK(hall.copy.list == hall.authority.list);
  CHECK(hall.copy.beacon.secret == hall.authority.beacon.secret);
  const auto stored = read_authority(hall.copy_dir);
  CHECK(stored->revocations == hall.authority.revocations);
  CHECK(stored->beacon.number == 2);
  CHECK(read_file(hall.copy_dir + "/fleet.json")->find("\"beacon_key_number\":2") != std::string::npos);
}

TEST_CASE("who has no passphrase learns the list, and makes up no beacon key") {
  Restored hall;
  hall.put_back();
  hall.copy = *read_authority(hall.copy_dir);
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(*hall.hear());
  CHECK(hall.copy.beacon.number == 2);
  CHECK(hall.copy.beacon.secret.empty());
}

TEST_CASE("an older list, and one that the authority did not sign, change nothing") {
  Restored hall;
  REQUIRE(hall.revoke("ur3").ok());
  const SignedRecord older = hall.authority.revocations;
  REQUIRE(hall.revoke("ur5").ok());
  hall.put_back();
  const RevocationList before = hall.copy.list;
  const auto learned = catch_up(hall.copy, hall.copy_dir, {older, {}});
  REQUIRE(learned.ok());
  CHECK_FALSE(*learned);
  SignedRecord forged = older;
  forged.signature.bytes[0] ^= 1;
  CHECK(code_of(catch_up(hall.copy, hall.copy_dir, {forged, {}})) == Errc::bad_signature);
  CHECK(hall.copy.list == before);
  CHECK(hall.copy.beacon.number == 3);
}

TEST_CASE("news with a forged certificate among them is refused whole, its list too") {
  Restored hall;
  hall.put_back();
  SignedRecord forged = hall.renew("ur5");
  forged.signature.bytes[0] ^= 1;
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(code_of(hall.hear({forged})) == Errc::bad_signature);
  CHECK(hall.copy.list.number == 0);
}

TEST_CASE("two lists of one number are joined: nobody's entry is lost, and none stands twice") {
  Restored hall;
  const auto rows = [&] {
    std::vector<std::pair<std::string, std::uint64_t>> out;
    for (const Revocation& row : hall.copy.list.revoked) out.emplace_back(row.id, row.serial);
    return out;
  };
  using Rows = decltype(rows());
  SUBCASE("of two nodes, the later signed one in the other list") {
    hall.put_back();
    REQUIRE(hall.revoke("cloud").ok());
    REQUIRE(hall.revoke_in_copy("ur3", "sold").ok());
    CHECK(*hall.hear());
    CHECK(rows() == Rows{{"cloud", 3}, {"ur3", 1}});
  }
  SUBCASE("of one node and certificate") {
    hall.put_back();
    REQUIRE(hall.revoke("ur3", "stolen").ok());
    REQUIRE(hall.revoke_in_copy("ur3", "sold").ok());
    CHECK(*hall.hear());
    CHECK(rows() == Rows{{"ur3", 1}});
  }
  SUBCASE("of one node, whose newer certificate the other list covers") {
    hall.put_back();
    hall.renew("ur3");
    REQUIRE(hall.revoke("ur3").ok());
    REQUIRE(hall.revoke_in_copy("ur3", "sold").ok());
    CHECK(*hall.hear());
    CHECK(rows() == Rows{{"ur3", 4}});
  }
  SUBCASE("of one node, whose newer certificate only the own list covers") {
    const Certificate first = hall.living("ur3");
    hall.renew("ur3");
    hall.put_back();
    REQUIRE(revoke_certificates(hall.authority, hall.dir, {first}, "stolen", kNow).ok());
    REQUIRE(hall.revoke_in_copy("ur3", "sold").ok());
    CHECK(*hall.hear());
    CHECK(find_living(hall.copy, "ur3", kNow) == nullptr);
  }
}

namespace {

/// A node that was signed after the copy was made, and was revoked; the folder is restored, and has heard the list.
struct RevokedSince : Restored {
  Certificate thief;
  SignedRecord asked;

  RevokedSince() {
    put_back();
    join("thief");
    thief = living("thief");
    asked = request("thief", "thief");
    REQUIRE(revoke("thief").ok());
    REQUIRE(*hear());
  }
  Status next(const std::vector<Certificate>& over = {}, UtcTime at = kNow) {
    return revoke_certificates(copy, copy_dir, over, "sold", at);
  }
};

}  // namespace

TEST_CASE("who was signed and revoked after the copy stays revoked in every list that the restored folder makes") {
  RevokedSince hall;
  REQUIRE(hall.next({*find_living(hall.copy, "ur5", kNow)}).ok());
  CHECK(find_revocation(hall.copy.list, hall.thief) != nullptr);
  // As long as the certificate that this folder never had.
  REQUIRE(hall.next({}, {hall.thief.not_after - 1}).ok());
  CHECK(find_revocation(hall.copy.list, hall.thief) != nullptr);
  REQUIRE(hall.next({}, UtcTime{hall.thief.not_after} + kEndLeeway).ok());
  CHECK(find_revocation(hall.copy.list, hall.thief) == nullptr);
}

TEST_CASE(
    "a list of an earlier version does not say until when an entry is needed: it stays for as long as any is valid") {
  RevokedSince hall;
  for (Revocation& entry : hall.copy.list.revoked) entry = {entry.serial, entry.id, entry.reason, entry.at};
  hall.copy.revoked.clear();
  REQUIRE(hall.next({}, kNow + 20 * kYear).ok());
  CHECK(find_revocation(hall.copy.list, hall.thief) != nullptr);
  REQUIRE(hall.next({}, kNow + kLongestValidity + kEndLeeway).ok());
  CHECK(hall.copy.list.revoked.empty());
}

TEST_CASE(
    "the keys of who was revoked after the copy are signed under no name, also when no list names them any more") {
  RevokedSince hall;
  CHECK(code_of(sign_request(hall.copy, hall.copy_dir, hall.asked, kNow, kYear)) == Errc::cert_revoked);
  const SignedRecord renamed = hall.request("thief", "friend");
  CHECK(code_of(sign_request(hall.copy, hall.copy_dir, renamed, kNow, kYear)) == Errc::cert_revoked);
  const UtcTime later = kNow + 3 * kYear;
  REQUIRE(hall.next({}, later).ok());
  REQUIRE(hall.copy.list.revoked.empty());
  Authority stored = *read_authority(hall.copy_dir);
  CHECK(code_of(sign_request(stored, hall.copy_dir, hall.asked, later, kYear)) == Errc::cert_revoked);
  // A new computer of that name has other keys.
  stored.key = hall.authority.key;
  CHECK(sign_request(stored, hall.copy_dir, hall.request("new-pc", "thief"), later, kYear).ok());
}

TEST_CASE("a restored folder gives no serial that its newer copy may have given, and says so on disk") {
  RevokedSince hall;
  CHECK(hall.copy.next_serial > hall.thief.serial + 1000);
  const auto stored = read_authority(hall.copy_dir);
  CHECK(stored->next_serial == hall.copy.next_serial);
  CHECK(stored->skipped_to == hall.copy.skipped_to);
  CHECK(stored->skipped == hall.copy.skipped);
  CHECK(hall.copy.next_serial == hall.copy.skipped_to + 1);
  // Nothing was signed since: nothing need be passed over again.
  REQUIRE(hall.revoke("ur5").ok());
  REQUIRE(*hall.hear());
  CHECK(hall.copy.next_serial == stored->next_serial);
}

TEST_CASE("who is revoked by a restored folder is revoked with the certificates that only its newer copy knows") {
  Restored hall;
  hall.put_back();
  hall.join("ur3");  // signed again, and shown to nobody who is asked
  const Certificate unknown = hall.living("ur3");
  REQUIRE(hall.revoke("ur5").ok());
  REQUIRE(*hall.hear());
  REQUIRE(hall.revoke_in_copy("ur3", "stolen").ok());
  const Revocation* entry = find_revocation(hall.copy.list, unknown);
  REQUIRE(entry != nullptr);
  // A router that is told a list without it later goes by that.
  CHECK(entry->until >= unknown.not_after);
  // Its successor is none of them.
  const auto successor = sign_request(hall.copy, hall.copy_dir, hall.request("new-pc", "ur3"), kNow, kYear);
  REQUIRE(successor.ok());
  CHECK(find_revocation(hall.copy.list, *decode<Certificate>(successor->certificate.payload.bytes)) == nullptr);
}

TEST_CASE("of two copies that are used in turn neither forgets whom it revoked: the next list has all") {
  Restored hall;
  hall.put_back();
  REQUIRE(hall.revoke("ur3").ok());
  // Twice, and nobody has told this copy: its list is the newer one.
  REQUIRE(hall.revoke_in_copy("ur5", "sold").ok());
  REQUIRE(revoke_certificates(hall.copy, hall.copy_dir, {}, "", kNow).ok());
  REQUIRE(*catch_up(hall.authority, hall.dir, {hall.copy.revocations, {}}));
  const Authority stored = *hall.read();
  CHECK(find_living(stored, "ur3", kNow) == nullptr);
  REQUIRE(missing_from_list(stored, kNow).size() == 1);
  CHECK(missing_from_list(stored, kNow).front().id == "ur3");
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", kNow).ok());
  CHECK(hall.authority.list.revoked.size() == 2);
  CHECK(missing_from_list(hall.authority, kNow).empty());
}
