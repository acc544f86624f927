// certificate.json: what it brings to its node, and which error a damaged one gives.
#include "common/security/certificate_file.hpp"

#include "common/base/hex.hpp"
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

TEST_CASE("seeds are kept in the file, and refused where they are none") {
  const SigningKey authority = (init_crypto(), make_signing_key());
  CertificateFile file;
  file.certificate = sign(kSignedCertificate, "", Bytes(16, 'f'), "payload", authority);
  file.authority = {"hall", authority.public_key};
  file.sealed_beacon = Bytes(80, 'b');
  CHECK(certificate_file_from_json(certificate_file_to_json(file))->seeds.empty());
  file.seeds = {{"10.0.0.1:45000", {Bytes(32, 'k')}}, {"[fd00::1]:45000", {Bytes(32, 'l')}}};
  CHECK(certificate_file_from_json(certificate_file_to_json(file))->seeds == file.seeds);
  file.seeds[1].address = "cloud.example:45000";
  CHECK(certificate_file_from_json(certificate_file_to_json(file)).error().what.find("seeds: address") == 0);
  file.seeds[1] = {"10.0.0.2:45000", {"short"}};
  CHECK(certificate_file_from_json(certificate_file_to_json(file)).error().what.find("seeds: key") == 0);
  file.seeds.assign(kMaxFleetSeeds + 1, {"10.0.0.1:45000", {Bytes(32, 'k')}});
  CHECK_FALSE(certificate_file_from_json(certificate_file_to_json(file)).ok());
}

TEST_CASE("a certificate file carries the fleet, the certificate, the beacon key and the list of what is revoked") {
  Hall hall;
  hall.join("ur5");
  const auto first = hall.ask("ur3", "ur3");
  REQUIRE(first.ok());
  CHECK(certificate_file_to_json(*first).find("revocations") == std::string::npos);
  CHECK(certificate_file_from_json(certificate_file_to_json(*first))->revocations.kind.empty());
  REQUIRE(hall.revoke("ur5").ok());
  const auto sent = hall.ask("ur3", "ur3");
  const auto taken = certificate_file_from_json(certificate_file_to_json(*sent));
  REQUIRE(taken.ok());
  CHECK(taken->authority.name == "hall");
  CHECK(taken->authority.public_key == hall.authority.fleet.public_key);
  CHECK(taken->certificate == sent->certificate);
  CHECK(taken->beacon_number == 2);
  CHECK(taken->sealed_beacon == sent->sealed_beacon);
  CHECK(taken->revocations == hall.authority.revocations);
}

TEST_CASE("a certificate file that lacks something says what, and what to do") {
  Hall hall;
  hall.join("ur5");
  REQUIRE(hall.revoke("ur5").ok());
  const auto file = hall.ask("ur3", "ur3");
  REQUIRE(file.ok());
  const std::string good = certificate_file_to_json(*file);
  const std::string key = to_hex(file->authority.public_key);
  const std::string box = to_hex(file->sealed_beacon);
  const auto is = [](const std::string& text, Errc code, const std::string& what) {
    CAPTURE(text);
    const auto read = certificate_file_from_json(text);
    REQUIRE(code_of(read) == code);
    CHECK(read.error().what.find(what) != std::string::npos);
    CHECK(read.error().hint.find("trb fleet sign") != std::string::npos);
  };
  is(with(good, "\"certificate\":", "\"other\":"), Errc::missing, "certificate");
  is(with(good, "authority_key", "other"), Errc::missing, "authority_key");
  is(with(good, "\"" + key + "\"", "7"), Errc::missing, "authority_key");
  is(with(good, key, "no key"), Errc::malformed, "authority_key");
  is(with(good, key, key + "00"), Errc::malformed, "authority_key");
  is(with(good, "beacon_key_number", "other"), Errc::missing, "beacon_key_number");
  is(with(good, "\"beacon_key_number\":2", "\"beacon_key_number\":\"2\""), Errc::missing, "beacon_key_number");
  is(with(good, "sealed_beacon_key", "other"), Errc::missing, "sealed_beacon_key");
  is(with(good, box, box.substr(2)), Errc::malformed, "sealed_beacon_key");
  const auto list = good.find("\"revocations\":");
  CHECK_FALSE(certificate_file_from_json(good.substr(0, list) + "\"revocations\":7}").ok());
  CHECK_FALSE(certificate_file_from_json(with(good, "\"certificate\":{", "\"certificate\":{\"age\":7,")).ok());
  CHECK(code_of(certificate_file_from_json("{")) == Errc::malformed);
}

TEST_CASE("the fleet's name in a certificate file is for people: without it the file holds all the same") {
  Hall hall;
  const std::string good = certificate_file_to_json(*hall.ask("ur3", "ur3"));
  for (const std::string& nameless : {with(good, "\"fleet\":\"hall\",", ""), with(good, "\"hall\"", "7")}) {
    const auto read = certificate_file_from_json(nameless);
    REQUIRE(read.ok());
    CHECK(read->authority.name.empty());
  }
}

TEST_CASE("a certificate file that is not there, or damaged, is told with its path") {
  Hall hall;
  const std::string path = hall.root + "/certificate.json";
  CHECK(code_of(read_certificate_file(path)) == Errc::missing);
  CHECK(read_certificate_file(path).error().hint.find("request.json") != std::string::npos);
  REQUIRE(write_file(path, "{}").ok());
  CHECK(code_of(read_certificate_file(path)) == Errc::missing);
  CHECK(read_certificate_file(path).error().what == path + ": certificate: missing");
  REQUIRE(write_file(path, certificate_file_to_json(*hall.ask("ur3", "ur3"))).ok());
  CHECK(read_certificate_file(path).ok());
}

TEST_CASE("a beacon key opens with the link key that it was sealed for, and whole only") {
  init_crypto();
  const LinkKey own = make_link_key();
  const BeaconKey key{7, random_bytes(32)};
  const Bytes box = seal_beacon_key(key, own.public_key);
  CHECK(open_sealed_beacon_key(7, box, own)->secret == key.secret);
  CHECK(open_sealed_beacon_key(7, box, own)->number == 7);
  CHECK(code_of(open_sealed_beacon_key(7, box, make_link_key())) == Errc::wrong_key);
  CHECK(code_of(open_sealed_beacon_key(7, box.substr(1), own)) == Errc::wrong_key);
  CHECK(code_of(open_sealed_beacon_key(7, "", own)) == Errc::wrong_key);
  // A key of another length would leave bytes uninitialized, or write past the end.
  CHECK(code_of(open_sealed_beacon_key(7, seal_beacon_key({7, Bytes(31, 'k')}, own.public_key), own)) ==
        Errc::wrong_key);
}

TEST_CASE("each number has its own beacon key, from the authority's secret alone") {
  init_crypto();
  const SigningKey key = make_signing_key();
  CHECK(derive_beacon_key(key.secret_key, 2).secret == derive_beacon_key(key.secret_key, 2).secret);
  CHECK(derive_beacon_key(key.secret_key, 2).secret != derive_beacon_key(key.secret_key, 3).secret);
  CHECK(derive_beacon_key(key.secret_key, 2).secret != derive_beacon_key(make_signing_key().secret_key, 2).secret);
  CHECK(derive_beacon_key(key.secret_key, 2).number == 2);
}
