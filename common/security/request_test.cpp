// Whom the authority certifies, and with which rights; and what its folder records.
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// The certificate request of a node with these keys.
SignedRecord ask_with(const SigningKey& identity, const Bytes& link_key, const std::string& id) {
  const CertificateRequest request{id, Role::robot, {identity.public_key}, {link_key}};
  return sign(kSignedRequest, id, {}, encode(request), identity);
}

}  // namespace

TEST_CASE("a request that is none, or names no link key, is not certified") {
  Hall hall;
  const SigningKey identity = make_signing_key();
  const auto asked = [&](const SignedRecord& record) {
    return code_of(sign_request(hall.authority, hall.dir, record, kNow, kYear));
  };
  CHECK(asked(ask_with(identity, Bytes(31, 'l'), "ur3")) == Errc::bad_signature);
  CHECK(asked(ask_with(identity, Bytes(32, 'l'), "No Id")) == Errc::bad_value);
  CHECK(asked(sign(kSignedRequest, "ur3", {}, "no request", identity)) != Errc::ok);
  CHECK(hall.authority.issued.empty());
  CHECK(asked(ask_with(identity, Bytes(32, 'l'), "ur3")) == Errc::ok);
}

TEST_CASE("one new key of two is another computer: neither goes under the name of a living one") {
  Hall hall;
  hall.join("ur3");
  for (const char* file : {"/identity.key", "/link.key"}) {
    const std::string path = hall.keys_of("ur3") + file;
    const std::string kept = *read_file(path);
    std::filesystem::remove(path);
    CHECK(code_of(hall.ask("ur3", "ur3")) == Errc::conflict);
    REQUIRE(write_file(path, kept, 0600).ok());
  }
  CHECK(hall.ask("ur3", "ur3").ok());
}

TEST_CASE("the key of a living member is not signed under a second name: with that name the member would be revoked") {
  Hall hall;
  hall.join("cloud", Role::cloud);
  const SigningKey own = make_signing_key();
  const auto refused =
      sign_request(hall.authority, hall.dir, ask_with(own, hall.living("cloud").link_key.bytes, "thief"), kNow, kYear);
  REQUIRE(code_of(refused) == Errc::conflict);
  CHECK(refused.error().what.find("'cloud'") != std::string::npos);
  CHECK(code_of(hall.ask("cloud", "copy")) == Errc::conflict);
  CHECK(hall.ask("cloud", "cloud").ok());
  CHECK(hall.authority.issued.size() == 2);
}

TEST_CASE("one revoked key of two is enough: a thief gets no new name with it") {
  Hall hall;
  hall.join("ur3");
  hall.join("ur5");
  REQUIRE(hall.revoke("ur3").ok());
  for (const char* file : {"/identity.key", "/link.key"}) {
    const std::string path = hall.keys_of("ur3") + file;
    const std::string kept = *read_file(path);
    std::filesystem::remove(path);
    const auto refused = hall.ask("ur3", "thief");
    CHECK(code_of(refused) == Errc::cert_revoked);
    CHECK(refused.error().what.find("'ur3'") != std::string::npos);
    REQUIRE(write_file(path, kept, 0600).ok());
  }
  CHECK(hall.ask("ur5", "ur5").ok());
  CHECK(hall.ask("other", "other").ok());
}

TEST_CASE("a node relays if it is a cloud's, or if the authority says so, and stays what it is when it is renewed") {
  Hall hall;
  const auto signed_as = [&](const std::string& id, Role role, RelayRight relay) {
    REQUIRE(sign_request(hall.authority, hall.dir, hall.request(id, id, role), kNow, kYear, relay).ok());
    return hall.living(id).relay;
  };
  CHECK_FALSE(signed_as("robot", Role::robot, RelayRight::by_role));
  CHECK(signed_as("carrier", Role::robot, RelayRight::yes));
  CHECK_FALSE(signed_as("guard", Role::robot, RelayRight::no));
  CHECK(signed_as("cloud", Role::cloud, RelayRight::by_role));
  CHECK(signed_as("cloud-2", Role::cloud, RelayRight::yes));
  CHECK_FALSE(signed_as("cloud-3", Role::cloud, RelayRight::no));

  const auto renewed = [&](Certificate old, RelayRight relay) {
    REQUIRE(renew_certificates(hall.authority, hall.dir, {old}, kNow, kYear, relay).ok());
    return hall.living(old.id).relay;
  };
  CHECK_FALSE(renewed(hall.living("robot"), RelayRight::by_role));
  CHECK(renewed(hall.living("carrier"), RelayRight::by_role));
  CHECK(renewed(hall.living("robot"), RelayRight::yes));
  CHECK_FALSE(renewed(hall.living("carrier"), RelayRight::no));
  CHECK_FALSE(renewed(hall.living("cloud"), RelayRight::no));
  Certificate earlier = hall.living("cloud-2");
  earlier.relay = false;  // its version had no such right
  CHECK(renewed(earlier, RelayRight::by_role));
}

TEST_CASE("a certificate is living up to its last moment, and not in it") {
  Hall hall;
  hall.join("ur3");
  const Certificate own = hall.living("ur3");
  CHECK(find_living(hall.authority, "ur3", {own.not_after - 1}) != nullptr);
  CHECK(find_living(hall.authority, "ur3", {own.not_after}) == nullptr);
  // A clock that is slightly behind finds it valid.
  CHECK(own.not_before == (kNow - std::chrono::minutes(5)).ns);
  hall.join("ur3");
  CHECK(hall.living("ur3").serial == 2);
}

TEST_CASE("of two certificates of one serial, which a folder put back may have signed, the first one counts") {
  Hall hall;
  hall.join("ur3");
  Certificate twin = hall.living("ur3");
  twin.link_key.bytes = Bytes(32, 'l');
  hall.authority.issued.push_back(twin);
  CHECK(find_living(hall.authority, "ur3", kNow) == &hall.authority.issued.front());
}

TEST_CASE("what cannot be stored is not handed out") {
  Hall hall;
  hall.join("ur3");
  for (const char* name : {"/fleet.json", "/issued.json"}) {
    std::filesystem::remove(hall.dir + name);
    std::filesystem::create_directories(hall.dir + name + "/in-the-way");
    CHECK(code_of(hall.ask("ur3", "ur3")) == Errc::io_error);
    CHECK(code_of(renew_certificates(hall.authority, hall.dir, {hall.living("ur3")}, kNow, kYear)) == Errc::io_error);
    std::filesystem::remove_all(hall.dir + name);
  }
  CHECK(hall.ask("ur3", "ur3").ok());
}

TEST_CASE("no serial is given twice, though fleet.json is from an older copy than issued.json") {
  Hall hall;
  hall.join("ur3");
  const auto older = read_file(hall.dir + "/fleet.json");
  hall.join("ur5");
  hall.join("cloud");
  REQUIRE(write_file(hall.dir + "/fleet.json", *older).ok());
  CHECK(hall.read()->next_serial == 4);
}

TEST_CASE("files of the folder in which something else stands are told by their names") {
  Hall hall;
  hall.join("ur3");
  hall.join("ur5");
  REQUIRE(hall.revoke("ur3").ok());
  const auto is = [&](const std::string& file, const std::string& text, Errc code) {
    CAPTURE(file);
    CAPTURE(text);
    const std::string good = *read_file(hall.dir + file);
    REQUIRE(write_file(hall.dir + file, text).ok());
    const auto read = hall.read();
    CHECK(code_of(read) == code);
    CHECK(read.error().what.find(hall.dir + file) == 0);
    REQUIRE(write_file(hall.dir + file, good).ok());
    CHECK(hall.read().ok());
  };
  is("/issued.json", "{}", Errc::malformed);
  is("/issued.json", R"({"certificates":7})", Errc::malformed);
  is("/issued.json", R"({"certificates":[7]})", Errc::malformed);
  is("/revocations.json", "{", Errc::malformed);
  is("/revocations.json", std::string((1U << 20U) + 1, ' '), Errc::too_large);
  std::filesystem::remove(hall.dir + "/issued.json");
  std::filesystem::create_directories(hall.dir + "/issued.json");
  CHECK(code_of(hall.read()) == Errc::io_error);
}

TEST_CASE("a certificate that comes late takes its place among the older ones, and is kept once") {
  Hall hall;
  for (const char* id : {"ur3", "ur5", "cloud"}) hall.join(id);
  const std::vector<Certificate> all = hall.authority.issued;
  const SignedRecord middle = hall.sign_certificate(all[1]);
  hall.authority.issued = {all[0], all[2]};
  CHECK(adopt_certificate(hall.authority, hall.dir, middle).ok());
  CHECK(adopt_certificate(hall.authority, hall.dir, middle).ok());
  CHECK(hall.authority.issued == all);
  CHECK(hall.read()->issued == all);
  CHECK(hall.authority.next_serial == 4);
  std::filesystem::remove(hall.dir + "/issued.json");
  std::filesystem::create_directories(hall.dir + "/issued.json/in-the-way");
  hall.authority.issued.pop_back();
  CHECK(code_of(adopt_certificate(hall.authority, hall.dir, hall.sign_certificate(all[2]))) == Errc::io_error);
}
