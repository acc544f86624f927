// A node's keys folder: what is read from it, and the errors of an incomplete one.
#include "common/security/node_keys.hpp"

#include <sys/stat.h>

#include "common/base/hex.hpp"
#include "common/base/test/closed_folder.hpp"
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// A node whose certificate has ended, and what a person puts beside it.
struct Late : Hall {
  Late() {
    join("ur3");
    join("ur5");
  }
  void put(const std::vector<SignedRecord>& certificates) {
    REQUIRE(write_trust_updates(keys_of("ur3") + "/news.json", {{}, certificates}).ok());
  }
  SignedRecord renew(const std::string& id) {
    return renew_certificates(authority, dir, {living(id)}, kNow, 2 * kYear)->front();
  }
  std::uint64_t serial() const { return keys("ur3")->certificate.serial; }
};

}  // namespace

TEST_CASE("a renewal that lies beside the certificate is taken, with its record, and the newest of several") {
  Late hall;
  const SignedRecord first = hall.renew("ur3");
  const SignedRecord second = hall.renew("ur3");
  hall.put({first});
  CHECK(hall.serial() == 3);
  hall.put({first, second});
  CHECK(hall.serial() == 4);
  hall.put({second, first});
  CHECK(hall.serial() == 4);
  CHECK(hall.keys("ur3")->certificate_record == second);
}

TEST_CASE("the certificate is read without any secret, and a renewal beside it is taken, too") {
  Late hall;
  hall.put({hall.renew("ur3")});
  const std::string folder = hall.keys_of("ur3");
  for (const char* secret : {"/identity.key", "/link.key"}) REQUIRE(::remove((folder + secret).c_str()) == 0);
  const auto read = load_node_certificate(folder + "/..");
  REQUIRE(read.ok());
  CHECK(read->certificate.id == "ur3");
  CHECK(read->certificate.serial == 3);
  CHECK(read->authority.id() == hall.authority.fleet.id());
  CHECK(hall.keys("ur3").error().code == Errc::missing);
}

TEST_CASE("a renewal of another node, of another fleet, of other keys, or none that is newer, is not taken") {
  Late hall;
  const Certificate own = hall.living("ur3");
  const auto changed = [&](auto change) {
    Certificate out = own;
    out.serial = 9;
    change(out);
    return out;
  };
  hall.put({hall.renew("ur5")});
  CHECK(hall.serial() == 1);
  Certificate another_id = changed([](Certificate& c) { c.id = "ur5"; });
  Certificate another_identity = changed([](Certificate& c) { c.identity_key.bytes = Bytes(32, 'i'); });
  Certificate another_link = changed([](Certificate& c) { c.link_key.bytes = Bytes(32, 'l'); });
  Certificate same_serial = changed([&](Certificate& c) { c.serial = own.serial, ++c.not_after; });
  for (const Certificate& other : {another_id, another_identity, another_link, same_serial}) {
    hall.put({hall.sign_certificate(other)});
    CHECK(hall.keys("ur3")->certificate == own);
  }
  const Hall stranger;
  const SignedRecord foreign = sign(kSignedCertificate, "", hall.authority.fleet.id(),
                                    encode(changed([](Certificate&) {})), stranger.authority.key);
  hall.put({foreign});
  CHECK(hall.serial() == 1);
  // The valid parts are taken nevertheless.
  hall.put({foreign, hall.sign_certificate(another_link), hall.renew("ur3")});
  CHECK(hall.serial() == 4);
}

TEST_CASE("news that cannot be read keep no node from starting") {
  Late hall;
  REQUIRE(write_file(hall.keys_of("ur3") + "/news.json", "{").ok());
  CHECK(hall.serial() == 1);
}

TEST_CASE("each file that is missing, damaged or not the node's is told") {
  Late hall;
  CHECK(code_of(make_request(hall.root + "/x", "No Id", Role::robot)) == Errc::bad_value);
  CHECK_FALSE(file_exists(hall.root + "/x"));
  for (const char* file : {"/identity.key", "/link.key", "/certificate.json"}) {
    CAPTURE(file);
    const std::string path = hall.keys_of("ur3") + file;
    const std::string good = *read_file(path);
    std::filesystem::remove(path);
    const auto gone = hall.keys("ur3");
    CHECK(code_of(gone) == Errc::missing);
    CHECK(gone.error().what.find(path) == 0);
    REQUIRE(write_file(path, "no key").ok());
    CHECK(code_of(hall.keys("ur3")) == Errc::malformed);
    REQUIRE(write_file(path, std::string(5000, '0')).ok());
    CHECK_FALSE(hall.keys("ur3").ok());
    // One key of two belongs to another computer.
    REQUIRE(write_file(path, *read_file(hall.keys_of("ur5") + file)).ok());
    CHECK(code_of(hall.keys("ur3")) == Errc::wrong_key);
    REQUIRE(write_file(path, good).ok());
    CHECK(hall.keys("ur3").ok());
  }
  // A person who edits a key may remove the newline at the end.
  const std::string path = hall.keys_of("ur3") + "/link.key";
  const std::string good = *read_file(path);
  for (const std::string& text : {good.substr(0, 64), good + "\n"}) {
    REQUIRE(write_file(path, text).ok());
    CHECK(hall.keys("ur3").ok());
  }
  REQUIRE(write_file(path, good.substr(2)).ok());
  CHECK(code_of(hall.keys("ur3")) == Errc::malformed);
}

TEST_CASE("a certificate of a stranger's authority, and a beacon key for another node, are told") {
  Late hall;
  const std::string path = hall.keys_of("ur3") + "/certificate.json";
  CertificateFile file = *read_certificate_file(path);
  const CertificateFile good = file;
  file.authority.public_key = make_signing_key().public_key;
  REQUIRE(write_file(path, certificate_file_to_json(file)).ok());
  CHECK(code_of(hall.keys("ur3")) == Errc::foreign_fleet);
  file = good;
  file.sealed_beacon = read_certificate_file(hall.keys_of("ur5") + "/certificate.json")->sealed_beacon;
  REQUIRE(write_file(path, certificate_file_to_json(file)).ok());
  CHECK(code_of(hall.keys("ur3")) == Errc::wrong_key);
}

TEST_CASE("keys that cannot be made, or are there and damaged, end a request") {
  Late hall;
  REQUIRE(write_file(hall.keys_of("ur3") + "/link.key", "no key", 0600).ok());
  CHECK(code_of(make_request(hall.root + "/ur3", "ur3", Role::robot)) == Errc::malformed);
  CHECK(*read_file(hall.keys_of("ur3") + "/link.key") == "no key");  // an existing key is never overwritten
  REQUIRE(write_file(hall.keys_of("ur5") + "/identity.key", "no key", 0600).ok());
  CHECK(code_of(make_request(hall.root + "/ur5", "ur5", Role::robot)) == Errc::malformed);
  REQUIRE(write_file(hall.root + "/file", "").ok());
  CHECK(code_of(make_request(hall.root + "/file", "ur3", Role::robot)) == Errc::io_error);
}

TEST_CASE("trb check names the fault of a folder once, and the last moment of a certificate is not over") {
  Late hall;
  const auto faults = [&](const std::string& node, UtcTime now) {
    ConfigFaults out;
    check_node_keys(hall.root + "/" + node, "ur3", now, out);
    return out;
  };
  const std::int64_t end = hall.living("ur3").not_after;
  CHECK(faults("ur3", {end - 1}).empty());
  REQUIRE(faults("ur3", {end}).size() == 1);
  CHECK(faults("ur3", {end})[0].hint.find("trb fleet renew") != std::string::npos);
  REQUIRE(faults("nowhere", kNow).size() == 1);
  CHECK(faults("nowhere", kNow)[0].file == "keys");
  CHECK(faults("nowhere", kNow)[0].hint.find("trb fleet request") != std::string::npos);
  // First the cure of a slip; a signed request would be a second member with the same keys.
  REQUIRE(faults("ur5", kNow).size() == 1);
  CHECK(faults("ur5", kNow)[0].hint.find("correct \"id\" in node.json to 'ur5'; or, if it shall be 'ur3'") == 0);
  CHECK(hall.ask("ur5", "wrogn").error().hint.find("correct \"id\" in its node.json to 'ur5'") != std::string::npos);
}

TEST_CASE("keys that this user may not read are not told as missing: nobody shall make new ones") {
  Late hall;
  const ClosedFolder closed(hall.keys_of("ur3"));
  ::chmod(hall.root.c_str(), 0755);
  ConfigFaults faults;
  check_node_keys(hall.root + "/ur3", "ur3", kNow, faults);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].what.find("Permission denied") != std::string::npos);
  CHECK(faults[0].hint.find("run it as the user of the services") == 0);
  CHECK(load_node_certificate(hall.root + "/ur3").error().hint.find("run it as the user of the services") == 0);
}
