#include "common/config/resilience_file.hpp"

#include <doctest/doctest.h>

#include "common/base/files.hpp"
#include "common/config/node_folder.hpp"
#include "tests/support/paths.hpp"

using namespace trb;

namespace {

ResilienceSettings read(const std::string& text, ConfigFaults& faults) {
  const auto json = parse_json(text);
  REQUIRE(json.ok());
  return read_resilience(*json, "resilience.json", faults);
}

ResilienceSettings good(const std::string& text) {
  ConfigFaults faults;
  const ResilienceSettings out = read(text, faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
  return out;
}

std::string fault_of(const std::string& text) {
  ConfigFaults faults;
  read(text, faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK_FALSE(faults[0].cure.empty());
  return faults[0].key;
}

}  // namespace

TEST_CASE("without a file Figure 8's priorities count, and people decide") {
  const NodeFolder folder;
  CHECK(without_keys(folder.check().faults).empty());
  const ResilienceSettings settings = default_resilience();
  CHECK(settings.weights.distance == doctest::Approx(0.5396).epsilon(0.001));
  CHECK(settings.weights.battery == doctest::Approx(0.2970).epsilon(0.001));
  CHECK(settings.weights.availability == doctest::Approx(0.1634).epsilon(0.001));
  CHECK_FALSE(settings.policy.automatic);
  CHECK_FALSE(settings.policy.asks_who_begins);
  CHECK(settings.expires == std::chrono::minutes(10));
}

TEST_CASE("the shipped files are good, and the one of the defaults says what they are") {
  const std::string folder = test::source_dir() + "/config/resilience/";
  CHECK(good(*read_file(folder + "figure-8.json")).weights == default_resilience().weights);
  const ResilienceSettings automatic = good(*read_file(folder + "automatic.json"));
  CHECK(automatic.policy.automatic);
  CHECK(automatic.policy.max_severity == Severity::critical);
  CHECK(automatic.weights == ReplacementWeights{0.25, 0.5, 0.25});
}

TEST_CASE("a policy moves one task twice, or as often as the file says, 16 times at most") {
  CHECK(default_resilience().policy.max_moves == 2);
  CHECK(good(R"({"policy": {"mode": "automatic", "max_moves": 16}})").policy.max_moves == 16);
  for (const char* wrong : {"0", "17", "1.5"}) {
    CHECK(fault_of(std::string(R"({"policy": {"mode": "automatic", "max_moves": )") + wrong + "}}") ==
          "policy.max_moves");
  }
}

TEST_CASE("who does a task that names no robot is chosen without asking, unless people want to be asked") {
  CHECK_FALSE(good(R"({"policy": {"mode": "ask"}})").policy.asks_who_begins);
  CHECK(good(R"({"policy": {"mode": "automatic", "bind": "ask"}})").policy.asks_who_begins);
}

TEST_CASE("weights or judgments; a chain of judgments is enough") {
  CHECK(good(R"({"criteria": {"distance": 3}})").weights == ReplacementWeights{0, 1, 0});
  const auto weights = good(R"({"judgments": [["battery", "distance", 2], ["distance", "availability", 2]]})").weights;
  CHECK(weights.battery == doctest::Approx(4.0 / 7));
  CHECK(weights.availability == doctest::Approx(1.0 / 7));
}

TEST_CASE("what is wrong is named, and keeps its default") {
  CHECK(fault_of(R"({"criteria": {"charge": 1, "battery": 1}})") == "criteria.charge");
  CHECK(fault_of(R"({"criteria": {"battery": 0}})") == "criteria");
  CHECK(fault_of(R"({"criteria": {"battery": 1}, "judgments": []})") == "criteria");
  CHECK(fault_of(R"({"judgments": [["battery", "distance"]]})") == "judgments[0]");
  CHECK(fault_of(R"({"judgments": [["battery", "distance", 2]]})") == "judgments");
  CHECK(fault_of(R"({"judgments": [["battery", "distance", 9], ["distance", "availability", 9],
                                   ["availability", "battery", 9]]})") == "judgments");
  CHECK(fault_of(R"({"policy": {"mode": "never"}})") == "policy.mode");
  CHECK(fault_of(R"({"policy": {"mode": "ask", "bind": "maybe"}})") == "policy.bind");
  CHECK(fault_of(R"({"policy": {"mode": "automatic", "conditions": {"min_lead": 2}}})") ==
        "policy.conditions.min_lead");
  CHECK(fault_of(R"({"expires_s": 0})") == "expires_s");
  CHECK(fault_of(R"({"expire_s": 5})") == "expire_s");
  CHECK(fault_of("[]") == "");
  ConfigFaults faults;
  CHECK(read(R"({"criteria": {"battery": -1, "distance": 1}})", faults).weights.distance == 1);
}

TEST_CASE("trb check tells the faults of resilience.json") {
  const NodeFolder folder;
  folder.write("resilience.json", R"({"policy": {}})");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK(faults[0].file == "resilience.json");
  CHECK(faults[0].key == "policy.mode");
}
