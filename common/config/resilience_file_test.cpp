#include "common/config/resilience_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/base/files.hpp"
#include "tests/support/node_folder.hpp"
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
  ResilienceSettings out = read(text, faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
  return out;
}

double weight_of(const ResilienceSettings& settings, const std::string& name) {
  for (const ReplacementCriterion& one : settings.criteria) {
    if (one.name == name) return one.weight;
  }
  return -1;
}

const ReplacementCriterion& criterion(const ResilienceSettings& settings, const std::string& name) {
  const auto at = std::ranges::find(settings.criteria, name, &ReplacementCriterion::name);
  REQUIRE(at != settings.criteria.end());
  return *at;
}

std::string fault_of(const std::string& text) {
  ConfigFaults faults;
  read(text, faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK_FALSE(faults[0].hint.empty());
  return faults[0].key;
}

}  // namespace

TEST_CASE("without a file Figure 8's priorities count, and people decide") {
  const NodeFolder folder;
  CHECK(without_keys(folder.check().faults).empty());
  const ResilienceSettings settings = default_resilience();
  CHECK(weight_of(settings, "distance") == doctest::Approx(0.5396).epsilon(0.001));
  CHECK(weight_of(settings, "battery") == doctest::Approx(0.2970).epsilon(0.001));
  CHECK(weight_of(settings, "availability") == doctest::Approx(0.1634).epsilon(0.001));
  CHECK_FALSE(settings.policy.automatic);
  CHECK_FALSE(settings.policy.asks_who_begins);
  CHECK(settings.expires == std::chrono::minutes(10));
}

TEST_CASE("the shipped files are good, and the one of the defaults says what they are") {
  const std::string folder = test::source_dir() + "/config/resilience/";
  CHECK(good(*read_file(folder + "figure-8.json")).criteria == default_resilience().criteria);
  const ResilienceSettings automatic = good(*read_file(folder + "automatic.json"));
  CHECK(automatic.policy.automatic);
  CHECK(automatic.policy.max_severity == Severity::critical);
  CHECK(weight_of(automatic, "battery") == doctest::Approx(0.25));
  CHECK(weight_of(automatic, "distance") == doctest::Approx(0.5));
  CHECK(weight_of(automatic, "availability") == doctest::Approx(0.25));
  const ResilienceSettings payload = good(*read_file(folder + "payload.json"));
  CHECK(payload.criteria.size() == 4);
  CHECK(criterion(payload, "battery").at_least == 20);
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
  const ResilienceSettings one = good(R"({"criteria": {"distance": 3}})");
  CHECK(weight_of(one, "distance") == 1);
  CHECK(weight_of(one, "battery") == 0);
  const auto judged = good(R"({"judgments": [["battery", "distance", 2], ["distance", "availability", 2]]})");
  CHECK(weight_of(judged, "battery") == doctest::Approx(4.0 / 7));
  CHECK(weight_of(judged, "availability") == doctest::Approx(1.0 / 7));
}

TEST_CASE("what is wrong is named, and keeps its default") {
  CHECK(fault_of(R"({"criteria": {"charge": 1, "battery": 1}})") == "criteria.charge");
  CHECK(fault_of(R"({"criteria": {"battery": 0}})") == "criteria");
  CHECK(fault_of(R"({"criteria": {"battery": 1}, "judgments": []})") == "criteria.battery");
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
  const auto wrong = read(R"({"criteria": {"battery": -1, "distance": 1}})", faults);
  CHECK(wrong.criteria == default_resilience().criteria);
}

TEST_CASE("criteria of the operator's own, from the robot, its description or a sensor, with bounds") {
  const ResilienceSettings settings = good(R"({"criteria": {
      "_comment": "what lifts",
      "battery": {"weight": 1, "at_least": 20},
      "payload": {"weight": 2, "from": "description", "unit": "kg", "best": 10, "worst": 0, "capabilities": ["grab"]},
      "heat": {"weight": 1, "from": "sensor", "value": "temperature", "unit": "degC", "best": 20, "worst": 80, "at_most": 70},
      "grip": {"weight": 0, "from": "robot", "best": 1, "worst": 0}}})");
  REQUIRE(settings.criteria.size() == 6);
  CHECK(settings.criteria[0] == ReplacementCriterion{"battery", CriterionSource::charge, 0.25, "", "%", 100, 0, 20});
  CHECK(weight_of(settings, "distance") == 0);
  CHECK(criterion(settings, "payload").weight == 0.5);
  CHECK(criterion(settings, "payload").value == "payload");
  CHECK(criterion(settings, "payload").capabilities == std::vector<std::string>{"grab"});
  CHECK(criterion(settings, "heat").from == CriterionSource::sensor);
  CHECK(criterion(settings, "heat").value == "temperature");
  CHECK(criterion(settings, "heat").at_most == 70);
  CHECK(criterion(settings, "grip").from == CriterionSource::robot);
}

TEST_CASE("judgments weigh all that is listed") {
  const ResilienceSettings settings = good(R"({
      "criteria": {"battery": {}, "payload": {"from": "description", "best": 10, "worst": 0}},
      "judgments": [["payload", "battery", 3]]})");
  CHECK(weight_of(settings, "payload") == doctest::Approx(0.75));
  CHECK(weight_of(settings, "battery") == doctest::Approx(0.25));
  CHECK(weight_of(settings, "distance") == 0);
  CHECK(fault_of(R"({"criteria": {"battery": {}}, "judgments": [["distance", "battery", 3]]})") == "judgments");
  CHECK(fault_of(R"({"criteria": {"battery": {"weight": 1}}, "judgments": []})") == "criteria.battery.weight");
}

TEST_CASE("a criterion that cannot be is named") {
  const auto of = [](const std::string& criterion) {
    return fault_of(R"({"criteria": {"payload": )" + criterion + "}}");
  };
  CHECK(of("3") == "criteria.payload");
  CHECK(of("[]") == "criteria.payload");
  CHECK(of(R"({"best": 1, "worst": 0})") == "criteria.payload.from");
  CHECK(of(R"({"from": "hearsay", "best": 1, "worst": 0})") == "criteria.payload.from");
  CHECK(of(R"({"from": "robot", "worst": 0})") == "criteria.payload.best");
  CHECK(of(R"({"from": "robot", "best": 1})") == "criteria.payload.worst");
  CHECK(of(R"({"from": "robot", "best": 1, "worst": 1})") == "criteria.payload.best");
  CHECK(of(R"({"from": "robot", "best": 1, "worst": 0, "at_least": 2, "at_most": 1})") == "criteria.payload.at_least");
  CHECK(of(R"({"from": "robot", "best": 1, "worst": 0, "weight": -1})") == "criteria.payload.weight");
  CHECK(of(R"({"from": "robot", "best": 1, "worst": 0, "value": ")" + std::string(57, 'x') + R"("})") ==
        "criteria.payload.value");
  CHECK(of(R"({"from": "robot", "best": 1, "worst": 0, "bast": 2})") == "criteria.payload.bast");
  CHECK(fault_of(R"({"criteria": {"battery": {"from": "robot"}}})") == "criteria.battery.from");
  CHECK(fault_of(R"({"criteria": {"Big one": 1}})") == "criteria.Big one");
  ConfigFaults faults;
  read(R"({"criteria": {"payLoad": {"from": "robot", "best": 1, "worst": 0}}})", faults);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].hint.starts_with("use small letters, digits, _ and -"));
  CHECK(fault_of(R"({"criteria": {}})") == "criteria");
  std::string many = R"({"criteria": {"battery": 1)";
  for (int i = 0; i < 16; ++i) {
    many += R"(, "c)" + std::to_string(i) + R"(": {"from": "robot", "best": 1, "worst": 0})";
  }
  CHECK(fault_of(many + "}}") == "criteria.c15");
}

TEST_CASE("trb check tells the faults of resilience.json") {
  const NodeFolder folder;
  folder.write("resilience.json", R"({"policy": {}})");
  const ConfigFaults faults = without_keys(folder.check().faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  CHECK(faults[0].file == "resilience.json");
  CHECK(faults[0].key == "policy.mode");
}
