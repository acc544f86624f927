// The authority's records: renewals, revocations, the beacon key of each list.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "common/security/authority.hpp"
#include "common/security/ever_revoked.hpp"
#include "common/security/node_keys.hpp"
#include "common/security/revocations.hpp"
#include "proto/body.hpp"

using namespace trb;

namespace {

constexpr UtcTime kNow{1'772'366'400'000'000'000};
constexpr Duration kYear = std::chrono::hours(24 * 365);
const std::string kPassphrase = "correct horse battery";

/// An authority and nodes that ask it.
struct Hall {
  TemporaryFolder temporary;
  std::string root = temporary.path;
  std::string dir = root + "/fleet";
  Authority authority = [this] {
    init_crypto();
    return *make_authority(dir, "hall", kPassphrase);
  }();

  Result<CertificateFile> ask(const std::string& folder, const std::string& id) {
    REQUIRE(make_request(root + "/" + folder, id, Role::robot).ok());
    const auto request = from_json<SignedRecord>(*read_file(root + "/" + folder + "/keys/request.json"));
    return sign_request(authority, dir, *request, kNow, kYear);
  }
  void join(const std::string& id) {
    auto file = ask(id, id);
    REQUIRE(file.ok());
    REQUIRE(write_file(root + "/" + id + "/keys/certificate.json", certificate_file_to_json(*file)).ok());
  }
  NodeKeys keys(const std::string& id) const { return *load_node_keys(root + "/" + id); }
  Certificate living(const std::string& id) const { return *find_living(authority, id, kNow); }
  Status revoke(const std::string& id) { return revoke_certificates(authority, dir, {living(id)}, "stolen", kNow); }
  Authority reopened() const { return *open_authority(dir, kPassphrase); }
};

template <class T>
Errc code_of(const Result<T>& result) {
  return result.ok() ? Errc::ok : result.error().code;
}

}  // namespace

TEST_CASE("a revocation names the node, is numbered, and brings those that stay a beacon key that it cannot open") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  REQUIRE(hall.revoke("ur3").ok());
  const Authority opened = hall.reopened();
  CHECK(opened.list == hall.authority.list);
  CHECK(opened.list.number == 1);
  CHECK(opened.beacon.number == 2);
  CHECK(opened.beacon.secret == hall.authority.beacon.secret);
  CHECK(opened.beacon.secret != hall.keys("ur5").beacon.secret);
  const auto list = open_revocations(opened.revocations, opened.fleet);
  REQUIRE(list.ok());
  CHECK(find_revocation(*list, hall.keys("ur3").certificate)->reason == "stolen");
  CHECK(find_revocation(*list, hall.keys("ur5").certificate) == nullptr);
  CHECK(open_listed_beacon_key(*list, "ur5", hall.keys("ur5").link)->secret == opened.beacon.secret);
  CHECK(code_of(open_listed_beacon_key(*list, "ur3", hall.keys("ur3").link)) == Errc::missing);
  CHECK(code_of(open_listed_beacon_key(*list, "ur5", hall.keys("ur3").link)) == Errc::wrong_key);
  CHECK(code_of(open_revocations(opened.revocations, {"other", Bytes(32, 'x')})) == Errc::foreign_fleet);
}

TEST_CASE("a list holds all that is revoked, until every certificate that it covers has ended") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  REQUIRE(hall.revoke("ur3").ok());
  REQUIRE(hall.revoke("ur5").ok());
  CHECK(hall.authority.list.number == 2);
  CHECK(hall.authority.list.revoked.size() == 2);
  const Certificate cloud = hall.living("cloud");
  // Who is named is in the list, ended or not; the others are not needed.
  const UtcTime behind = kNow + kYear + kEndLeeway;
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {cloud}, "", behind).ok());
  REQUIRE(hall.authority.list.revoked.size() == 1);
  CHECK(hall.authority.list.revoked.front().id == "cloud");
  REQUIRE(revoke_certificates(hall.authority, hall.dir, {}, "", behind).ok());
  CHECK(hall.authority.list.revoked.empty());
}

TEST_CASE("a revocation covers the older certificates of the same node, and not the one of its successor") {
  Hall hall;
  hall.join("ur3");
  const Certificate first = hall.living("ur3");
  hall.join("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(find_revocation(hall.authority.list, first) != nullptr);
  CHECK(find_living(hall.authority, "ur3", kNow) == nullptr);
  CHECK(code_of(hall.ask("ur3", "ur3")) == Errc::cert_revoked);  // its keys are revoked for ever
  auto successor = hall.ask("new-pc", "ur3");
  REQUIRE(successor.ok());
  CHECK(find_revocation(hall.authority.list, hall.living("ur3")) == nullptr);
  CHECK(successor->revocations == hall.authority.revocations);
}

TEST_CASE("another computer under the name of a living one is not certified") {
  Hall hall;
  hall.join("ur3");
  const auto refused = hall.ask("new-pc", "ur3");
  CHECK(code_of(refused) == Errc::conflict);
  CHECK(refused.error().hint.find("trb fleet revoke") != std::string::npos);
  CHECK(hall.ask("ur3", "ur3").ok());  // the same keys: a renewal
}

TEST_CASE("a validity that no clock can hold is refused, and takes no serial") {
  Hall hall;
  hall.join("ur3");
  const auto serial = hall.authority.next_serial;
  for (const Duration days :
       {std::chrono::hours(24 * 100'000), std::chrono::hours(24 * 36'501), std::chrono::hours(0)}) {
    CHECK(code_of(renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow, days,
                                     RelayRight::by_role)) == Errc::bad_value);
  }
  CHECK(hall.authority.next_serial == serial);
  CHECK(hall.reopened().next_serial == serial);
}

TEST_CASE("a renewed certificate has the same keys, a higher serial, and stands in the news until a newer one does") {
  Hall hall;
  hall.join("ur3");
  const Certificate old = hall.living("ur3");
  const auto renewed = renew_certificates(hall.authority, hall.dir, {old}, kNow, 2 * kYear);
  REQUIRE(renewed.ok());
  const auto opened = open_certificate(renewed->front(), hall.authority.fleet, kNow + kYear + Duration(1));
  REQUIRE(opened.ok());
  CHECK(opened->serial == old.serial + 1);
  CHECK(opened->link_key == old.link_key);
  CHECK(hall.reopened().next_serial == old.serial + 2);
  CHECK(read_trust_updates(hall.dir + "/news.json")->certificates == *renewed);
  REQUIRE(hall.revoke("ur3").ok());
  REQUIRE(publish_trust_updates(hall.authority, hall.dir, {}, kNow).ok());
  CHECK(read_trust_updates(hall.dir + "/news.json")->certificates.empty());
  CHECK(read_trust_updates(hall.dir + "/news.json")->revocations == hall.authority.revocations);
}

TEST_CASE("a folder of an earlier version opens; its certificates are adopted when they are named") {
  Hall hall;
  hall.join("ur3");
  REQUIRE(std::filesystem::remove(hall.dir + "/issued.json"));
  Authority opened = hall.reopened();
  CHECK(opened.issued.empty());
  CHECK(opened.next_serial == 2);
  const NodeKeys keys = hall.keys("ur3");
  CHECK(adopt_certificate(opened, hall.dir, keys.certificate_record)->id == "ur3");
  CHECK(hall.reopened().issued == std::vector{keys.certificate});
  SignedRecord forged = keys.certificate_record;
  forged.signature.bytes[0] ^= 1;
  CHECK(code_of(adopt_certificate(opened, hall.dir, forged)) == Errc::bad_signature);
}

TEST_CASE("a folder put back from an older copy takes over what the fleet knows: nothing revoked comes back by it") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  std::filesystem::copy(hall.dir, hall.root + "/copy");
  const auto renewed = renew_certificates(hall.authority, hall.dir, {hall.living("cloud")}, kNow, kYear);
  REQUIRE(renewed.ok());
  REQUIRE(hall.revoke("ur3").ok());
  const TrustUpdate known{hall.authority.revocations, *renewed};

  Authority copy = *open_authority(hall.root + "/copy", kPassphrase);
  CHECK(find_living(copy, "ur3", kNow) != nullptr);
  REQUIRE(catch_up(copy, hall.root + "/copy", known).ok());
  CHECK(find_living(copy, "ur3", kNow) == nullptr);
  CHECK(copy.next_serial >= hall.authority.next_serial);
  CHECK(copy.beacon.secret == hall.authority.beacon.secret);
  CHECK_FALSE(*catch_up(copy, hall.root + "/copy", known));
  CHECK(open_authority(hall.root + "/copy", kPassphrase)->list.number == 1);
  CHECK_FALSE(*catch_up(hall.authority, hall.dir, {copy.revocations, {}}));
}

TEST_CASE("of two lists of one number the next one says what either says") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  std::filesystem::copy(hall.dir, hall.root + "/copy");
  REQUIRE(hall.revoke("ur3").ok());
  Authority copy = *open_authority(hall.root + "/copy", kPassphrase);
  REQUIRE(revoke_certificates(copy, hall.root + "/copy", {*find_living(copy, "ur5", kNow)}, "sold", kNow).ok());
  REQUIRE(*catch_up(copy, hall.root + "/copy", {hall.authority.revocations, {}}));
  REQUIRE(revoke_certificates(copy, hall.root + "/copy", {}, "", kNow).ok());
  CHECK(copy.list.number == 2);
  CHECK(copy.list.revoked.size() == 2);
}

TEST_CASE("damaged files of the authority's folder are told, never taken for empty") {
  Hall hall;
  hall.join("ur3");
  REQUIRE(hall.revoke("ur3").ok());
  REQUIRE(write_file(hall.dir + "/issued.json", "{").ok());
  CHECK(code_of(open_authority(hall.dir, kPassphrase)) == Errc::malformed);
  REQUIRE(write_file(hall.dir + "/issued.json", R"({"certificates":[]})").ok());
  SignedRecord forged = hall.authority.revocations;
  forged.signature.bytes[0] ^= 1;
  REQUIRE(write_file(hall.dir + "/revocations.json", to_json(forged)).ok());
  CHECK(code_of(open_authority(hall.dir, kPassphrase)) == Errc::bad_signature);
}

TEST_CASE("a list that cannot be stored is none: nothing of it is on disk, and it can be made again") {
  Hall hall;
  hall.join("ur3");
  hall.join("ur5");
  const Authority before = hall.authority;
  // A folder with the file's name: replacing the file fails, as on a full disk.
  std::filesystem::create_directories(hall.dir + "/revocations.json/in-the-way");
  CHECK(hall.revoke("ur3").error().code == Errc::io_error);
  CHECK(hall.authority.list.number == 0);
  CHECK(hall.authority.beacon.number == before.beacon.number);
  CHECK(find_living(hall.authority, "ur3", kNow) != nullptr);
  for (const auto& entry : std::filesystem::directory_iterator(hall.dir))
    CHECK_MESSAGE(entry.path().string().find(".new") == std::string::npos, entry.path().string());
  std::filesystem::remove_all(hall.dir + "/revocations.json");
  CHECK(find_living(hall.reopened(), "ur3", kNow) != nullptr);
  REQUIRE(hall.revoke("ur3").ok());
  CHECK(hall.reopened().list.number == 1);
}

TEST_CASE("a list that is stored counts, whatever becomes of the copy of its beacon number in fleet.json") {
  Hall hall;
  hall.join("ur3");
  hall.join("ur5");
  const auto fleet = read_file(hall.dir + "/fleet.json");
  std::filesystem::remove(hall.dir + "/fleet.json");
  std::filesystem::create_directories(hall.dir + "/fleet.json/in-the-way");
  CHECK(hall.revoke("ur3").ok());
  std::filesystem::remove_all(hall.dir + "/fleet.json");
  REQUIRE(write_file(hall.dir + "/fleet.json", *fleet).ok());
  CHECK(hall.reopened().beacon.number == hall.authority.beacon.number);
  CHECK(hall.reopened().beacon.secret == hall.authority.beacon.secret);
}

TEST_CASE("a renewal is in the news before it counts: whoever is interrupted behind that has lost nothing") {
  Hall hall;
  for (const char* id : {"ur3", "ur5"}) hall.join(id);
  const auto issued = read_file(hall.dir + "/issued.json");
  const auto fleet = read_file(hall.dir + "/fleet.json");
  REQUIRE(renew_certificates(hall.authority, hall.dir, {hall.living("ur3"), hall.living("ur5")}, kNow, kYear).ok());
  const auto news = read_trust_updates(hall.dir + "/news.json")->certificates;
  CHECK(news.size() == 2);
  // Killed behind the first of the three files, and behind the first of the other two.
  REQUIRE(write_file(hall.dir + "/fleet.json", *fleet).ok());
  for (const bool is_named : {true, false}) {
    if (!is_named) REQUIRE(write_file(hall.dir + "/issued.json", *issued).ok());
    Authority opened = hall.reopened();
    CHECK(opened.issued == hall.authority.issued);
    CHECK(opened.next_serial == 5);
    REQUIRE(publish_trust_updates(opened, hall.dir, {}, kNow).ok());
    CHECK(read_trust_updates(hall.dir + "/news.json")->certificates == news);
  }
}

TEST_CASE("a renewal that only the news have is kept when it is revoked, and leaves them") {
  Hall hall;
  for (const char* id : {"ur3", "ur5"}) hall.join(id);
  const auto issued = read_file(hall.dir + "/issued.json");
  REQUIRE(renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow, 2 * kYear).ok());
  REQUIRE(write_file(hall.dir + "/issued.json", *issued).ok());
  Authority opened = hall.reopened();
  REQUIRE(revoke_certificates(opened, hall.dir, {*find_living(opened, "ur3", kNow)}, "stolen", kNow).ok());
  REQUIRE(publish_trust_updates(opened, hall.dir, {}, kNow).ok());
  CHECK(read_trust_updates(hall.dir + "/news.json")->certificates.empty());
  // Behind the end of the first one, the entry is still needed.
  Authority later = hall.reopened();
  CHECK(later.issued == hall.authority.issued);
  const UtcTime behind = kNow + kYear + kEndLeeway;
  REQUIRE(revoke_certificates(later, hall.dir, {}, "", behind).ok());
  CHECK(find_revocation(later.list, hall.authority.issued.back()) != nullptr);
}

TEST_CASE("a renewal that the news cannot hold is none, for any of those that were named") {
  Hall hall;
  for (const char* id : {"ur3", "ur5"}) hall.join(id);
  const std::vector<Certificate> both{hall.living("ur3"), hall.living("ur5")};
  std::filesystem::create_directories(hall.dir + "/news.json/in-the-way");
  CHECK(code_of(renew_certificates(hall.authority, hall.dir, both, kNow, kYear)) == Errc::io_error);
  CHECK(hall.living("ur3") == both[0]);
  CHECK(hall.reopened().issued == both);
  CHECK(hall.reopened().next_serial == 3);
}

TEST_CASE("a renewal stays in the news until a newer one is there: one that is only counted replaces none") {
  Hall hall;
  for (const char* id : {"ur3", "ur5"}) hall.join(id);
  const auto renewed = renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow, kYear);
  REQUIRE(renewed.ok());
  REQUIRE(hall.ask("ur3", "ur3").ok());  // and the certificate is lost on its way
  REQUIRE(hall.revoke("ur5").ok());
  REQUIRE(publish_trust_updates(hall.authority, hall.dir, {}, kNow).ok());
  CHECK(read_trust_updates(hall.dir + "/news.json")->certificates == *renewed);
}

TEST_CASE("what is forged, or of another fleet, does not count as issued because the news have it") {
  Hall hall;
  Hall other;
  for (Hall* one : {&hall, &other}) one->join("ur3");
  auto forged = renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow, kYear)->front();
  auto foreign = renew_certificates(other.authority, other.dir, {other.living("ur3")}, kNow, kYear)->front();
  const auto before = hall.reopened().issued;
  const auto more = [&](SignedRecord record) {
    auto body = *decode<Certificate>(record.payload.bytes);
    body.serial = 9;
    record.payload.bytes = encode(body);
    return record;
  };
  REQUIRE(write_trust_updates(hall.dir + "/news.json", {{}, {more(forged), foreign}}).ok());
  CHECK(hall.reopened().issued == before);
}

TEST_CASE("a certificate that could not be kept takes no serial on disk: none is missing in the folder later") {
  Hall hall;
  hall.join("ur3");
  const auto fleet = read_file(hall.dir + "/fleet.json");
  const auto issued = read_file(hall.dir + "/issued.json");
  std::filesystem::remove(hall.dir + "/issued.json");
  std::filesystem::create_directories(hall.dir + "/issued.json/in-the-way");
  CHECK(code_of(hall.ask("ur5", "ur5")) == Errc::io_error);
  CHECK(*read_file(hall.dir + "/fleet.json") == *fleet);
  std::filesystem::remove_all(hall.dir + "/issued.json");
  REQUIRE(write_file(hall.dir + "/issued.json", *issued).ok());
  // A kill behind the rows: the next serial follows from them.
  REQUIRE(hall.ask("ur5", "ur5").ok());
  REQUIRE(write_file(hall.dir + "/fleet.json", *fleet).ok());
  const Authority opened = hall.reopened();
  CHECK(opened.next_serial == opened.issued.back().serial + 1);
}
