// Keys, certificates, beacons, the authority's folder and a node's.
#include <doctest/doctest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "common/security/authority.hpp"
#include "common/security/node_keys.hpp"
#include "common/security/rights.hpp"
#include "proto/body.hpp"

using namespace trb;

namespace {

constexpr UtcTime kNow{1'772'366'400'000'000'000};
constexpr Duration kYear = std::chrono::hours(24 * 365);
const std::string kPassphrase = "correct horse battery";

struct Folder : TemporaryFolder {
  Folder() { init_crypto(); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

struct Fleet {
  Fleet() { init_crypto(); }
  SigningKey key = make_signing_key();
  FleetAuthority authority{"hall", key.public_key};
  SigningKey identity = make_signing_key();

  Certificate certificate(Role role = Role::robot) const {
    return {{authority.id()}, 1, "ur3", role, {identity.public_key}, {Bytes(32, 'l')}, kNow.ns, (kNow + kYear).ns};
  }
  SignedRecord issue(const Certificate& body) const {
    return sign(kSignedCertificate, "", authority.id(), encode(body), key);
  }
};

template <class T>
Errc code_of(const Result<T>& result) {
  return result.ok() ? Errc::ok : result.error().code;
}

}  // namespace

TEST_CASE("a certificate holds within its fleet and its time, and in no other") {
  const Fleet fleet;
  const Fleet other;
  const SignedRecord good = fleet.issue(fleet.certificate());
  CHECK(open_certificate(good, fleet.authority, kNow)->id == "ur3");
  CHECK(code_of(open_certificate(good, other.authority, kNow)) == Errc::foreign_fleet);
  CHECK(code_of(open_certificate(good, fleet.authority, kNow - Duration(1))) == Errc::cert_not_yet_valid);
  CHECK(code_of(open_certificate(good, fleet.authority, kNow + kYear)) == Errc::cert_expired);
  CHECK(open_certificate_any_time(good, fleet.authority).ok());
  Certificate short_key = fleet.certificate();
  short_key.link_key.bytes.pop_back();
  CHECK(code_of(open_certificate(fleet.issue(short_key), fleet.authority, kNow)) == Errc::malformed);
  const SignedRecord forged = sign(kSignedCertificate, "", fleet.authority.id(), good.payload.bytes, other.key);
  CHECK(code_of(open_certificate(forged, fleet.authority, kNow)) == Errc::bad_signature);
}

TEST_CASE("no byte of a certificate can be changed") {
  const Fleet fleet;
  const SignedRecord good = fleet.issue(fleet.certificate());
  for (std::size_t i = 0; i < good.payload.bytes.size(); ++i) {
    SignedRecord bad = good;
    bad.payload.bytes[i] = static_cast<char>(bad.payload.bytes[i] ^ 1);
    CHECK_FALSE(open_certificate(bad, fleet.authority, kNow).ok());
  }
  SignedRecord bad = good;
  bad.signature.bytes[0] = static_cast<char>(bad.signature.bytes[0] ^ 1);
  CHECK(code_of(open_certificate(bad, fleet.authority, kNow)) == Errc::bad_signature);
}

TEST_CASE("a signature holds for its purpose, fleet and signer alone") {
  const Fleet fleet;
  const Certificate ur3 = fleet.certificate();
  const Bytes payload = encode(AbortOrder{"r", "ur3", "", 0});
  const SignedRecord order = sign(kSignedRunAbort, "ur3", fleet.authority.id(), payload, fleet.identity);
  CHECK(open_record<AbortOrder>(order, kSignedRunAbort, ur3)->by == "ur3");
  CHECK(code_of(open_record<AbortOrder>(order, kSignedResult, ur3)) == Errc::bad_signature);
  SignedRecord renamed = order;
  renamed.kind = kSignedResult;
  CHECK(code_of(open_record<AbortOrder>(renamed, kSignedResult, ur3)) == Errc::bad_signature);
  SignedRecord lent = order;
  lent.signer = "ur5";
  CHECK(code_of(open_record<AbortOrder>(lent, kSignedRunAbort, ur3)) == Errc::source_mismatch);
  Certificate elsewhere = ur3;
  elsewhere.fleet.bytes = Bytes(16, 'x');
  CHECK(code_of(open_record<AbortOrder>(order, kSignedRunAbort, elsewhere)) == Errc::bad_signature);
  const SignedRecord decision = sign(kSignedDecision, "ur3", fleet.authority.id(), encode(Decision{}), fleet.identity);
  CHECK(code_of(open_record<Decision>(decision, kSignedDecision, ur3)) == Errc::not_permitted);
}

TEST_CASE("a record passes for no other kind, whatever its label says, and needs a whole key and signature") {
  const Fleet fleet;
  const Bytes id = fleet.authority.id();
  SignedRecord order = sign(kSignedRunAbort, "ur3", id, "payload", fleet.identity);
  CHECK(verify(order, kSignedRunAbort, id, fleet.identity.public_key));
  CHECK_FALSE(verify(order, kSignedRunAbort, id, fleet.key.public_key));
  CHECK_FALSE(verify(order, kSignedRunAbort, id, fleet.identity.public_key.substr(1)));
  CHECK_FALSE(verify(order, kSignedRunAbort, id, ""));
  SignedRecord cut = order;
  cut.signature.bytes.pop_back();
  CHECK_FALSE(verify(cut, kSignedRunAbort, id, fleet.identity.public_key));
  order.kind = kSignedResult;  // the signature is still that of an abort
  CHECK_FALSE(verify(order, kSignedRunAbort, id, fleet.identity.public_key));
}

TEST_CASE("a certificate needs both of its keys, and a payload that is one") {
  const Fleet fleet;
  Certificate short_key = fleet.certificate();
  short_key.identity_key.bytes.pop_back();
  CHECK(code_of(open_certificate_any_time(fleet.issue(short_key), fleet.authority)) == Errc::malformed);
  const SignedRecord none = sign(kSignedCertificate, "", fleet.authority.id(), "none", fleet.key);
  CHECK_FALSE(open_certificate(none, fleet.authority, kNow).ok());
}

TEST_CASE("newer keys are other keys of the same node, signed later: no renewal, and no certificate of before") {
  const Fleet fleet;
  const Certificate before = fleet.certificate();
  Certificate now = before;
  now.serial = 2;
  CHECK_FALSE(has_newer_keys(now, before));
  now.identity_key.bytes = Bytes(32, 'n');
  CHECK(has_newer_keys(now, before));
  CHECK_FALSE(has_newer_keys(before, now));
  now.id = "ur5";
  CHECK_FALSE(has_newer_keys(now, before));
}

TEST_CASE("a number by chance is never zero, which stands for none, and never the one before") {
  init_crypto();
  const std::uint64_t first = random_u64();
  const std::uint64_t second = random_u64();
  CHECK(first != 0);
  CHECK(second != 0);
  CHECK(first != second);
  CHECK(random_bytes(32) != random_bytes(32));
  CHECK(random_bytes(5).size() == 5);
}

TEST_CASE("who may sign what is a table, and what it does not name is denied") {
  for (const Role role : {Role::robot, Role::cloud}) {
    CHECK(may_sign(role, kSignedBeacon));
    CHECK(may_sign(role, kSignedRunStart));
    CHECK(may_sign(role, kSignedRunAbort));
    CHECK(may_sign(role, kSignedResult));  // a cloud node's result only ever says that its decision skips the task
    CHECK(may_sign(role, kSignedChoice));  // a cloud node's choice is on a condition that follows such a task
    CHECK(may_sign(role, kSignedDecision) == (role == Role::cloud));
    for (const std::string_view other :
         {kSignedCertificate, kSignedRequest, std::string_view(""), std::string_view("Result")}) {
      CHECK_FALSE(may_sign(role, other));
    }
  }
}

namespace {

/// A text sealed as a beacon.
struct TestBeacon {
  explicit TestBeacon(const Bytes& text) : sealed(seal_beacon(key, fleet, text)) {}
  BeaconKey key{3, Bytes(32, 'k')};
  Bytes fleet = Bytes(16, 'f');
  Bytes sealed;
};

}  // namespace

TEST_CASE("an empty beacon opens; noise of any length does not") {
  init_crypto();
  const auto& [key, fleet, sealed] = TestBeacon("");
  CHECK(*open_beacon(key, fleet, sealed) == "");
  CHECK(code_of(open_beacon(key, fleet, sealed.substr(0, sealed.size() - 1))) == Errc::malformed);
  CHECK(code_of(open_beacon(key, fleet, Bytes(sealed.size(), 'T'))) == Errc::malformed);
}

TEST_CASE("a beacon opens with its key, and each reason why it does not is told apart") {
  init_crypto();
  const auto& [key, fleet, sealed] = TestBeacon("hello");
  CHECK(*open_beacon(key, fleet, sealed) == "hello");
  CHECK(seal_beacon(key, fleet, "hello") != sealed);
  CHECK(code_of(open_beacon(key, fleet, "noise")) == Errc::malformed);
  CHECK(code_of(open_beacon(key, fleet, sealed.substr(0, 51))) == Errc::malformed);
  CHECK(code_of(open_beacon(key, Bytes(16, 'g'), sealed)) == Errc::foreign_fleet);
  CHECK(code_of(open_beacon({4, key.secret}, fleet, sealed)) == Errc::wrong_key);
  CHECK(code_of(open_beacon({3, Bytes(32, 'x')}, fleet, sealed)) == Errc::bad_signature);
  Bytes changed = sealed;
  changed.back() = static_cast<char>(changed.back() ^ 1);
  CHECK(code_of(open_beacon(key, fleet, changed)) == Errc::bad_signature);
}

TEST_CASE("the authority's folder is made once and opens with its passphrase only") {
  const Folder folder;
  const std::string dir = folder / "fleet";
  CHECK(code_of(make_authority(dir, "hall", "too short")) == Errc::bad_value);
  CHECK(code_of(make_authority(dir, "No Id", kPassphrase)) == Errc::bad_value);
  CHECK(code_of(open_authority(dir, kPassphrase)) == Errc::missing);
  const auto made = make_authority(dir, "hall", kPassphrase);
  REQUIRE(made.ok());
  CHECK(code_of(make_authority(dir, "hall", kPassphrase)) == Errc::conflict);
  const auto opened = open_authority(dir, kPassphrase);
  REQUIRE(opened.ok());
  CHECK(opened->key.secret_key == made->key.secret_key);
  CHECK(opened->beacon.secret == made->beacon.secret);
  CHECK(read_fleet(dir)->id() == made->fleet.id());
  CHECK(code_of(open_authority(dir, kPassphrase + "!")) == Errc::not_permitted);
  CHECK(read_file(dir + "/fleet.json")->find("secret") == Bytes::npos);
  REQUIRE(::chmod((dir + "/authority.key").c_str(), 0640) == 0);
  CHECK(code_of(open_authority(dir, kPassphrase)) == Errc::not_permitted);
}

namespace {

/// A fleet authority and two nodes whose requests are written.
struct Nodes {
  Folder folder;
  Authority authority = *make_authority(folder / "fleet", "hall", kPassphrase);

  Nodes() {
    REQUIRE(make_request(folder / "ur3", "ur3", Role::robot).ok());
    REQUIRE(make_request(folder / "ur5", "ur5", Role::robot).ok());
  }
  SignedRecord request(const std::string& node) const {
    return *from_json<SignedRecord>(*read_file(folder / (node + "/keys/request.json")));
  }
  CertificateFile issue(const std::string& node) {
    return *sign_request(authority, folder / "fleet", request(node), kNow, kYear);
  }
  void give(const std::string& node, const CertificateFile& file) {
    REQUIRE(write_file(folder / (node + "/keys/certificate.json"), certificate_file_to_json(file)).ok());
  }
  Result<NodeKeys> load(const std::string& node) const { return load_node_keys(folder / node); }
};

}  // namespace

TEST_CASE("a node's keys are requested, signed and loaded; serial numbers rise") {
  Nodes nodes;
  CHECK(code_of(nodes.load("ur3")) == Errc::missing);
  nodes.give("ur3", nodes.issue("ur3"));
  const auto keys = nodes.load("ur3");
  REQUIRE(keys.ok());
  CHECK(keys->certificate.id == "ur3");
  CHECK(keys->certificate.serial == 1);
  CHECK(keys->beacon.secret == nodes.authority.beacon.secret);
  CHECK(open_authority(nodes.folder / "fleet", kPassphrase)->next_serial == 2);
  nodes.give("ur3", nodes.issue("ur3"));
  CHECK(nodes.load("ur3")->certificate.serial == 2);
  CHECK(nodes.load("ur3")->identity.secret_key == keys->identity.secret_key);
}

TEST_CASE("a request that another key signed is not certified") {
  Nodes nodes;
  SignedRecord stolen = nodes.request("ur3");
  stolen.signature = nodes.request("ur5").signature;
  CHECK(code_of(sign_request(nodes.authority, nodes.folder / "fleet", stolen, kNow, kYear)) == Errc::bad_signature);
  CHECK(nodes.authority.next_serial == 1);
}

TEST_CASE("keys that others may read, or that the certificate is not for, are refused") {
  Nodes nodes;
  nodes.give("ur3", nodes.issue("ur5"));
  CHECK(code_of(nodes.load("ur3")) == Errc::wrong_key);
  CertificateFile mixed = nodes.issue("ur3");
  mixed.sealed_beacon = nodes.issue("ur5").sealed_beacon;
  nodes.give("ur3", mixed);
  CHECK(code_of(nodes.load("ur3")) == Errc::wrong_key);
  nodes.give("ur3", nodes.issue("ur3"));
  REQUIRE(::chmod((nodes.folder / "ur3/keys/link.key").c_str(), 0644) == 0);
  CHECK(code_of(nodes.load("ur3")) == Errc::not_permitted);
  REQUIRE(::chmod((nodes.folder / "ur3/keys/link.key").c_str(), 0600) == 0);
  REQUIRE(write_file(nodes.folder / "ur3/keys/identity.key", "00\n", 0600).ok());
  CHECK(code_of(nodes.load("ur3")) == Errc::malformed);
}

TEST_CASE("trb check's faults name another id and a certificate that has ended") {
  Nodes nodes;
  nodes.give("ur3", nodes.issue("ur3"));
  ConfigFaults faults;
  check_node_keys(nodes.folder / "ur3", "ur3", kNow, faults);
  CHECK(faults.empty());
  check_node_keys(nodes.folder / "ur3", "ur5", kNow + kYear, faults);
  REQUIRE(faults.size() == 2);
  CHECK(faults[0].key == "id");
  CHECK(faults[1].key == "not_after");
}
