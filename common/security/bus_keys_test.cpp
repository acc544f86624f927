// Keys of a bus over TCP: made once, never overwritten, and a faulty one is reported.
#include "common/security/bus_keys.hpp"
#include "common/base/test/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"

using namespace trb;

namespace {

const std::vector<std::string> kNames = {"router", "scheduler", "probe"};

struct Folder : TemporaryFolder {
  Folder() { init_crypto(); }
  [[nodiscard]] std::string at(const std::string& name) const { return path + "/keys/bus/" + name; }
  [[nodiscard]] ConfigFaults faults() const {
    ConfigFaults out;
    check_bus_keys(path, kNames, out);
    return out;
  }
};

}  // namespace

TEST_CASE("each name gets a key that its owner alone may read, and keeps it") {
  const Folder folder;
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  struct stat facts {};
  REQUIRE(::stat(folder.at("scheduler.key").c_str(), &facts) == 0);
  CHECK((facts.st_mode & 0777U) == 0600);
  const auto key = load_bus_key(folder.path, "scheduler");
  REQUIRE(key.ok());
  CHECK(*load_bus_public(folder.path, "scheduler") == key->public_key);
  CHECK(*load_bus_public(folder.path, "router") != key->public_key);
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  CHECK(load_bus_key(folder.path, "scheduler")->secret_key == key->secret_key);
  CHECK(folder.faults().empty());
}

TEST_CASE("a secret that was carried to its container is not made anew; a lost public half is") {
  const Folder folder;
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  const Bytes shown = *load_bus_public(folder.path, "scheduler");
  std::filesystem::remove(folder.at("scheduler.key"));
  std::filesystem::remove(folder.at("probe.pub"));
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  CHECK_FALSE(file_exists(folder.at("scheduler.key")));
  CHECK(*load_bus_public(folder.path, "scheduler") == shown);
  CHECK(*load_bus_public(folder.path, "probe") == load_bus_key(folder.path, "probe")->public_key);
  CHECK(folder.faults().empty());
}

TEST_CASE("keys that are missing, open to others, damaged or of two pairs are told apart") {
  const Folder folder;
  CHECK(load_bus_key(folder.path, "scheduler").error().code == Errc::missing);
  CHECK(load_bus_public(folder.path, "router").error().code == Errc::missing);
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  REQUIRE(::chmod(folder.at("scheduler.key").c_str(), 0644) == 0);
  CHECK(load_bus_key(folder.path, "scheduler").error().code == Errc::not_permitted);
  REQUIRE(write_file(folder.at("router.pub"), "00").ok());
  CHECK(load_bus_public(folder.path, "router").error().code == Errc::malformed);
  REQUIRE(write_file(folder.at("probe.pub"), to_hex(make_link_key().public_key)).ok());
  const ConfigFaults faults = folder.faults();
  REQUIRE(faults.size() == 3);
  CHECK(faults[0].file == "keys/bus/router.pub");
  CHECK(faults[1].file == "keys/bus/scheduler.key");
  CHECK(faults[2].file == "keys/bus/probe.pub");
  CHECK(faults[2].what.find("public half") != std::string::npos);
}

TEST_CASE("a public key that a hand has copied may end in no line or in two, and must be a key") {
  const Folder folder;
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  const Bytes key = *load_bus_public(folder.path, "router");
  for (const std::string& text : {to_hex(key), to_hex(key) + "\n\n"}) {
    REQUIRE(write_file(folder.at("router.pub"), text).ok());
    CHECK(*load_bus_public(folder.path, "router") == key);
  }
  for (const std::string& text : {std::string(), std::string("\n"), std::string("no key"), to_hex(key) + "00"}) {
    REQUIRE(write_file(folder.at("router.pub"), text).ok());
    const auto read = load_bus_public(folder.path, "router");
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().code == Errc::malformed);
    REQUIRE(folder.faults().size() == 1);
    CHECK(folder.faults()[0].file == "keys/bus/router.pub");
  }
}

TEST_CASE("a lost public half is not made anew from a secret that is damaged") {
  const Folder folder;
  REQUIRE(make_bus_keys(folder.path, kNames).ok());
  std::filesystem::remove(folder.at("probe.pub"));
  REQUIRE(write_file(folder.at("probe.key"), "no key", 0600).ok());
  CHECK(make_bus_keys(folder.path, kNames).error().code == Errc::malformed);
  CHECK_FALSE(file_exists(folder.at("probe.pub")));
  REQUIRE(folder.faults().size() == 1);
  CHECK(folder.faults()[0].file == "keys/bus/probe.key");
}
