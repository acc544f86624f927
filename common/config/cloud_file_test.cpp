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

TEST_CASE("cloud.json: how much history is kept") {
  CHECK(cloud_of("{}").settings.history_days == 30);
  const ReadCloud read = cloud_of(R"({"history": {"days": 7, "megabytes": 64}})");
  CHECK(read.faults.empty());
  CHECK(read.settings.history_days == 7);
  CHECK(read.settings.history_mb == 64);
}
