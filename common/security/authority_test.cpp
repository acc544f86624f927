// The authority's folder with something wrong in it: each faulty file is reported by name and never mistaken for
// another.
#include "common/security/authority.hpp"

#include "common/base/hex.hpp"
#include "common/security/test_hall.hpp"

using namespace trb;
using namespace trb::test;

namespace {

const std::string kTwelve = "twelve chars";

}  // namespace

TEST_CASE("a passphrase of twelve characters will do, one of eleven will not") {
  const Hall hall;
  const std::string dir = hall.root + "/other";
  REQUIRE(kTwelve.size() == kMinPassphrase);
  CHECK(code_of(make_authority(dir, "hall", kTwelve.substr(1))) == Errc::bad_value);
  CHECK_FALSE(file_exists(dir));
  REQUIRE(make_authority(dir, "hall", kTwelve).ok());
  // A copy of both files does not reveal the keys.
  const auto made = open_authority(dir, kTwelve);
  REQUIRE(made.ok());
  CHECK(read_file(dir + "/authority.key")->find(to_hex(made->beacon.secret)) == std::string::npos);
}

TEST_CASE("an authority.key that does not belong to its fleet.json, or was damaged, is told as that") {
  const Hall hall;
  const std::string dir = hall.root + "/other";
  REQUIRE(make_authority(dir, "hall", kTwelve).ok());
  const std::string key_file = dir + "/authority.key";
  const std::string mixed = hall.root + "/mixed";
  std::filesystem::copy(hall.dir, mixed);
  std::filesystem::copy(key_file, mixed);
  CHECK(code_of(open_authority(mixed, kTwelve)) == Errc::wrong_key);
  const std::string good_fleet = *read_file(dir + "/fleet.json");
  REQUIRE(write_file(dir + "/fleet.json", with(good_fleet, "next_serial", "serial")).ok());
  CHECK(code_of(open_authority(dir, kTwelve)) == Errc::malformed);
  REQUIRE(write_file(dir + "/fleet.json", good_fleet).ok());

  const std::string good = *read_file(key_file);
  for (const std::string& bad : {std::string("no key"), std::string("00ff\n"), good.substr(2)}) {
    REQUIRE(write_file(key_file, bad).ok());
    CHECK(code_of(open_authority(dir, kTwelve)) == Errc::malformed);
  }
  REQUIRE(write_file(key_file, std::string(5000, '0')).ok());
  CHECK(code_of(open_authority(dir, kTwelve)) == Errc::too_large);
  std::filesystem::remove(key_file);
  const auto gone = open_authority(dir, kTwelve);
  REQUIRE(code_of(gone) == Errc::missing);
  CHECK(gone.error().hint.find("trb fleet init") != std::string::npos);
}

TEST_CASE("one of an authority's two files is enough to keep a new one out of the folder") {
  const Hall hall;
  CHECK(code_of(make_authority(hall.dir, "hall", kTwelve)) == Errc::conflict);
  std::filesystem::rename(hall.dir + "/fleet.json", hall.dir + "/authority.key");
  CHECK(code_of(make_authority(hall.dir, "hall", kTwelve)) == Errc::conflict);
}

TEST_CASE("fleet.json says to people and programs who the fleet is") {
  const Hall hall;
  CHECK(read_file(hall.dir + "/fleet.json")->find(to_hex(hall.authority.fleet.id())) != std::string::npos);
  const auto fleet = read_fleet(hall.dir);
  REQUIRE(fleet.ok());
  CHECK(fleet->name == "hall");
  CHECK(fleet->public_key == hall.authority.key.public_key);
  const auto read = hall.read();
  REQUIRE(read.ok());
  CHECK(read->beacon.number == 1);
  CHECK(read->next_serial == 1);
  CHECK(read->key.secret_key.empty());
}

TEST_CASE("a fleet.json in which something is missing, or is of another kind, is told") {
  const Hall hall;
  const std::string path = hall.dir + "/fleet.json";
  const std::string good = *read_file(path);
  const std::string key = to_hex(hall.authority.fleet.public_key);
  for (const std::string& bad :
       {with(good, "\"name\"", "\"nobody\""), with(good, "\"hall\"", "7"), with(good, "authority_key", "other_key"),
        with(good, "\"" + key + "\"", "7"), with(good, key, "no hexadecimal text"), with(good, key, key.substr(2)),
        std::string("{"), std::string("[]")}) {
    CAPTURE(bad);
    REQUIRE(write_file(path, bad).ok());
    const auto fleet = read_fleet(hall.dir);
    CHECK(code_of(fleet) == Errc::malformed);
    CHECK(fleet.error().what.find(path) == 0);
    CHECK(code_of(hall.read()) == Errc::malformed);
  }
  for (const std::string& bad :
       {with(good, "next_serial", "serial"), with(good, "\"next_serial\":1", "\"next_serial\":\"1\""),
        with(good, "beacon_key_number", "number"),
        with(good, "\"beacon_key_number\":1", "\"beacon_key_number\":1.5")}) {
    CAPTURE(bad);
    REQUIRE(write_file(path, bad).ok());
    CHECK(read_fleet(hall.dir).ok());
    CHECK(code_of(hall.read()) == Errc::malformed);
  }
  std::filesystem::remove(path);
  CHECK(code_of(read_fleet(hall.dir)) == Errc::missing);
  CHECK(read_fleet(hall.dir).error().hint.find("trb fleet init") != std::string::npos);
}

TEST_CASE("a node's folder is no authority's, and becomes none") {
  const Hall hall;
  const std::string node = hall.dir + "/node";
  REQUIRE(make_dir(node).ok());
  REQUIRE(write_file(node + "/node.json", "{}").ok());
  CHECK(make_authority(node, "hall", "a long passphrase").error().code == Errc::conflict);
  CHECK(read_fleet(node).error().hint == "name the authority's folder (that of trb fleet init)");
  CHECK_FALSE(file_exists(node + "/authority.key"));
  for (const std::string& inside : {node + "/keys", node + "/keys/", node + "/keys/../keys"}) {
    CHECK(make_authority(inside, "hall", "a long passphrase").error().code == Errc::conflict);
    CHECK_FALSE(file_exists(inside));
  }
}
