#include "common/config/cloud_file.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

struct ReadCloud {
  CloudSettings settings;
  ConfigFaults faults;
};

ReadCloud cloud_of(const std::string& text) {
  ReadCloud out;
  const auto json = parse_json(text);
  REQUIRE(json);
  out.settings = read_cloud(*json, "cloud.json", out.faults);
  for (const ConfigFault& fault : out.faults) CHECK_FALSE(fault.hint.empty());
  return out;
}

}  // namespace

TEST_CASE("cloud.json: without it the gateway is reached from this machine alone") {
  const ReadCloud read = cloud_of("{}");
  CHECK(read.faults.empty());
  CHECK(read.settings.address == "127.0.0.1");
  CHECK(read.settings.origins() == std::vector<std::string>{"https://localhost:8443", "https://127.0.0.1:8443"});
}

TEST_CASE("cloud.json: an address and names are origins; the port of HTTPS is not written") {
  const ReadCloud read = cloud_of(R"({"listen": "[fd00::1]:443", "names": ["hall.example"]})");
  CHECK(read.faults.empty());
  CHECK(read.settings.address == "fd00::1");
  CHECK(read.settings.origins() == std::vector<std::string>{"https://localhost", "https://127.0.0.1",
                                                            "https://[fd00::1]", "https://hall.example"});
  const ReadCloud any = cloud_of(R"({"listen": "0.0.0.0:9000"})");
  CHECK(any.settings.port == 9000);
  CHECK(any.settings.origins().size() == 2);
}

TEST_CASE("cloud.json: what is wrong is named with the cure") {
  CHECK(cloud_of(R"({"listen": "hall:8443"})").faults.at(0).key == "listen");
  CHECK(cloud_of(R"({"listen": "127.0.0.1"})").faults.size() == 1);
  CHECK(cloud_of(R"({"names": ["good", "Bad Name", "-x", "a..b"]})").faults.size() == 3);
  CHECK(cloud_of(R"({"port": 1})").faults.size() == 1);
  CHECK(cloud_of(R"({"history": {"days": 0}})").faults.at(0).key == "history.days");
  CHECK(cloud_of(R"({"history": {"megabytes": 1.5, "years": 1}})").faults.size() == 2);
  CHECK(cloud_of(R"({"history": 30})").faults.size() == 1);
}

TEST_CASE("cloud.json: proxies are numeric addresses") {
  const ReadCloud read = cloud_of(R"({"proxies": ["10.0.0.7", "fd00::7"]})");
  CHECK(read.faults.empty());
  CHECK(read.settings.proxies == std::vector<std::string>{"10.0.0.7", "fd00::7"});
  for (const char* wrong : {"proxy.example", "10.0.0.7:443", "[fd00::7]", "10.0.0", "fd00::7]:2", ""}) {
    const ReadCloud refused = cloud_of(R"({"proxies": ["10.0.0.7", ")" + std::string(wrong) + R"("]})");
    REQUIRE(refused.faults.size() == 1);
    CHECK(refused.faults[0].key == "proxies[1]");
  }
}

TEST_CASE("cloud.json: how much history is kept") {
  CHECK(cloud_of("{}").settings.history_days == 30);
  const ReadCloud read = cloud_of(R"({"history": {"days": 7, "megabytes": 64}})");
  CHECK(read.faults.empty());
  CHECK(read.settings.history_days == 7);
  CHECK(read.settings.history_mb == 64);
}

TEST_CASE("cloud.json: a shared database, by its host or the folder of its socket") {
  CHECK_FALSE(cloud_of("{}").settings.database);
  const ReadCloud remote = cloud_of(R"({"database": "postgresql://trb@db.example:5433/hall"})");
  CHECK(remote.faults.empty());
  REQUIRE(remote.settings.database);
  CHECK(remote.settings.database->user == "trb");
  CHECK(remote.settings.database->host == "db.example");
  CHECK(remote.settings.database->port == 5433);
  CHECK(remote.settings.database->name == "hall");
  CHECK_FALSE(remote.settings.database->is_local());
  CHECK(remote.settings.database->text() == "postgresql://db.example:5433/hall");
  const ReadCloud socket = cloud_of(R"({"database": "postgresql://trb@/hall?host=/run/postgresql"})");
  REQUIRE(socket.settings.database);
  CHECK(socket.settings.database->host == "/run/postgresql");
  CHECK(socket.settings.database->is_local());
  CHECK(cloud_of(R"({"database": "postgresql://trb@[fd00::1]/hall"})").settings.database->host == "fd00::1");
  CHECK(cloud_of(R"({"database": "postgresql://trb@127.0.0.1/hall"})").settings.database->is_local());
}

TEST_CASE("cloud.json: what is no database is refused, and a password in it is not repeated") {
  for (const char* wrong :
       {"", "mysql://trb@db/hall", "postgresql://db/hall", "postgresql://trb@db", "postgresql://trb@db/",
        "postgresql://@db/hall", "postgresql://trb@db:0/hall", "postgresql://trb@db:65536/hall",
        "postgresql://trb@db/hall?sslmode=disable", "postgresql://trb@/hall", "postgresql://trb@/hall?host=run",
        "postgresql://trb@/hall?host=/run' host='x", "postgresql://trb@db/ha'll", "postgresql://t b@db/hall",
        "postgresql://trb@[fd00::1/hall", "postgresql://trb@db /hall"}) {
    CAPTURE(wrong);
    const ReadCloud read = cloud_of("{\"database\": \"" + std::string(wrong) + "\"}");
    REQUIRE(read.faults.size() == 1);
    CHECK(read.faults[0].key == "database");
    CHECK_FALSE(read.settings.database);
  }
  for (const char* secret : {"postgresql://trb:hidden@db/hall", "postgresql://trb@db/hall?password=hidden"}) {
    const ReadCloud read = cloud_of("{\"database\": \"" + std::string(secret) + "\"}");
    REQUIRE(read.faults.size() == 1);
    CHECK((read.faults[0].what + read.faults[0].hint).find("hidden") == std::string::npos);
    CHECK(read.faults[0].hint.find("keys/database.password") != std::string::npos);
  }
}

TEST_CASE("cloud.json: a name with a port is that of a proxy") {
  const ReadCloud read = cloud_of(R"({"names": ["hall.example:443", "hall.example:9443"]})");
  CHECK(read.faults.empty());
  const auto origins = read.settings.origins();
  CHECK(origins[2] == "https://hall.example");
  CHECK(origins[3] == "https://hall.example:9443");
  CHECK(cloud_of(R"({"names": ["hall.example:0", "hall.example:x", ":443"]})").faults.size() == 3);
}
