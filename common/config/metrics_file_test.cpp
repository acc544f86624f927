#include "common/config/metrics_file.hpp"

#include <doctest/doctest.h>

using namespace trb;

namespace {

/// The fault's key; empty if there is none.
std::string fault_of(const std::string& text, std::optional<MetricsAddress>& out) {
  ConfigFaults faults;
  out = read_metrics(*parse_json(text), "metrics.json", faults);
  if (faults.empty()) return "";
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0].key;
}

}  // namespace

TEST_CASE("metrics.json: an address of this machine alone") {
  std::optional<MetricsAddress> at;
  CHECK(fault_of(R"({"listen": "127.0.0.1:9464"})", at).empty());
  REQUIRE(at);
  CHECK(at->address == "127.0.0.1");
  CHECK(at->port == 9464);
}

TEST_CASE("metrics.json: what others could reach, or nobody, is refused") {
  std::optional<MetricsAddress> at;
  for (const char* listen : {"0.0.0.0:9464", "10.0.0.1:9464", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:65536",
                             "localhost:9464", "127.1:9464", "[::1]:9464", ""}) {
    CHECK_MESSAGE(fault_of(std::string(R"({"listen": ")") + listen + "\"}", at) == "listen", listen);
    CHECK_FALSE(at);
  }
  CHECK(fault_of("{}", at) == "listen");
  CHECK(fault_of(R"({"listen": "127.0.0.1:9464", "port": 1})", at) == "port");
}
