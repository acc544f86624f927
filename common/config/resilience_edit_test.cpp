#include "common/config/resilience_edit.hpp"

#include <doctest/doctest.h>

#include "common/config/json_edit.hpp"
#include "common/config/resilience_file.hpp"

using namespace trb;

namespace {

using enum ResiliencePart;

constexpr const char* kCommented = R"({
  "_comment": "ask the shift leader before you change this",
  "criteria": { "battery": { "weight": 1, "at_least": 20 }, "distance": 3 },
  "policy": { "mode": "ask", "_comment": "since the accident" },
  "_comment": "ten minutes",
  "expires_s": 600
}
)";

Value parsed_text(const std::string& text) {
  const auto out = parse_json(text);
  REQUIRE(out.ok());
  return *out;
}

std::string edited_text(std::string_view file, ResiliencePart part, const std::string& change) {
  ConfigFaults faults;
  const auto out = edit_resilience(file, part, parsed_text(change), faults);
  REQUIRE_MESSAGE(out.has_value(), to_text(faults));
  return *out;
}

ConfigFaults faults_of(std::string_view file, ResiliencePart part, const std::string& change) {
  ConfigFaults faults;
  CHECK_FALSE(edit_resilience(file, part, parsed_text(change), faults));
  REQUIRE_FALSE(faults.empty());
  for (const ConfigFault& one : faults) CHECK_FALSE(one.hint.empty());
  return faults;
}

ResilienceSettings settings_in(const std::string& text) {
  ConfigFaults faults;
  ResilienceSettings out = read_resilience(parsed_text(text), "resilience.json", faults);
  CHECK_MESSAGE(faults.empty(), to_text(faults));
  return out;
}

const ReplacementCriterion& criterion_in(const ResilienceSettings& settings, const std::string& name) {
  for (const ReplacementCriterion& one : settings.criteria) {
    if (one.name == name) return one;
  }
  FAIL(name);
  return settings.criteria.front();
}

}  // namespace

TEST_CASE("a new policy leaves every other byte of the file, comments too") {
  const std::string out = edited_text(kCommented, policy, R"({"mode": "automatic", "max_moves": 3, "expires_s": 60})");
  CHECK(out == R"({
  "_comment": "ask the shift leader before you change this",
  "criteria": { "battery": { "weight": 1, "at_least": 20 }, "distance": 3 },
  "policy": {"mode":"automatic","max_moves":3},
  "_comment": "ten minutes",
  "expires_s": 60
}
)");
  CHECK(settings_in(out).policy.automatic);
  CHECK(settings_in(out).expires == std::chrono::seconds(60));
}

TEST_CASE("what a policy leaves out has its default again") {
  const std::string out = edited_text(kCommented, policy, R"({"mode": "ask"})");
  CHECK(out.find("expires_s") == std::string::npos);
  CHECK(settings_in(out).policy.max_moves == 2);
}

TEST_CASE("the first change makes the file") {
  const std::string out = edited_text("", policy, R"({"mode": "automatic"})");
  CHECK(out == "{\n  \"policy\": {\"mode\":\"automatic\"}\n}\n");
}

TEST_CASE("new criteria take the place of judgments") {
  const char* judged =
      R"({"judgments": [["battery", "distance", 3], ["battery", "availability", 3], ["distance", "availability", 1]]})";
  const std::string out = edited_text(judged, criteria, R"({"criteria": {"battery": 1, "distance": {"weight": 1}}})");
  CHECK(out.find("judgments") == std::string::npos);
  CHECK(criterion_in(settings_in(out), "battery").weight == doctest::Approx(0.5));
  const std::string again = edited_text(
      out, criteria, R"({"criteria": {"battery": {}, "distance": {}}, "judgments": [["battery", "distance", 3]]})");
  CHECK(criterion_in(settings_in(again), "battery").weight == doctest::Approx(0.75));
}

TEST_CASE("minimums change bounds alone: weights stay, and who is not named has none") {
  const std::string out = edited_text(kCommented, minimums, R"({"distance": {"at_most": 40}})");
  const ResilienceSettings settings = settings_in(out);
  CHECK(criterion_in(settings, "distance").weight == doctest::Approx(0.75));
  CHECK(criterion_in(settings, "distance").at_most == 40);
  CHECK_FALSE(criterion_in(settings, "battery").at_least);
  CHECK(out.find("since the accident") != std::string::npos);
}

TEST_CASE("minimums of a file without criteria keep what counts by default") {
  const ResilienceSettings before = default_resilience();
  const ResilienceSettings after = settings_in(edited_text("", minimums, R"({"battery": {"at_least": 15}})"));
  for (const ReplacementCriterion& one : before.criteria) {
    CHECK(criterion_in(after, one.name).weight == doctest::Approx(one.weight));
  }
  CHECK(criterion_in(after, "battery").at_least == 15);
}

TEST_CASE("a minimum of one of the three that does not count yet") {
  const ResilienceSettings settings =
      settings_in(edited_text(kCommented, minimums, R"({"availability": {"at_least": 50}})"));
  CHECK(criterion_in(settings, "availability").weight == 0);
  CHECK(criterion_in(settings, "availability").at_least == 50);
}

TEST_CASE("minimums beside judgments") {
  const char* judged =
      R"({"judgments": [["battery", "distance", 3], ["battery", "availability", 3], ["distance", "availability", 1]]})";
  const ResilienceSettings settings = settings_in(edited_text(judged, minimums, R"({"battery": {"at_least": 30}})"));
  CHECK(criterion_in(settings, "battery").weight == doctest::Approx(0.6));
  CHECK(criterion_in(settings, "battery").at_least == 30);
  const char* two = R"({"criteria": {"battery": {}, "distance": {}}, "judgments": [["battery", "distance", 3]]})";
  CHECK(faults_of(two, minimums, R"({"availability": {"at_least": 1}})")[0].key == "availability");
}

TEST_CASE("every fault is told, where it is in the change") {
  const ConfigFaults of_policy =
      faults_of(kCommented, policy,
                R"({"mode": "never", "max_moves": 99, "conditions": {"min_score": 2}, "expires_s": -1, "x": 1})");
  std::vector<std::string> keys;
  for (const ConfigFault& one : of_policy) keys.push_back(one.key);
  for (const char* key : {"mode", "max_moves", "conditions.min_score", "expires_s", "x"}) {
    CHECK_MESSAGE(std::ranges::find(keys, key) != keys.end(), key);
  }
  CHECK(faults_of(kCommented, policy, "{}")[0].key == "mode");
  CHECK(faults_of(kCommented, policy, "[]")[0].key.empty());
  CHECK(faults_of(kCommented, criteria, R"({"criteria": {"battery": -1}})")[0].key == "criteria.battery");
  CHECK(faults_of(kCommented, criteria, R"({"criteria": {"battery": 0}})")[0].key == "criteria");
  CHECK(faults_of(kCommented, criteria, R"({"judgments": []})")[0].key == "criteria");
  CHECK(faults_of(kCommented, criteria, R"({"criteria": {"battery": 1}, "policy": {"mode": "automatic"}})")[0].key ==
        "policy");
  CHECK(faults_of(kCommented, minimums, R"({"payload": {"at_least": 1}})")[0].key == "payload");
  CHECK(faults_of(kCommented, minimums, R"({"battery": {"weight": 9}})")[0].key == "battery.weight");
  CHECK(faults_of(kCommented, minimums, R"({"battery": {"at_least": 9, "at_most": 1}})")[0].key == "battery.at_least");
  CHECK(faults_of(kCommented, minimums, R"({"battery": 9})")[0].key == "battery");
}

TEST_CASE("a file with faults is not changed") {
  CHECK(faults_of(R"({"criteria": 7})", minimums, R"({"battery": {"at_least": 1}})")[0].key == "criteria");
  CHECK_FALSE(faults_of("{", policy, R"({"mode": "ask"})").empty());
}

TEST_CASE("text that looks like a member is none") {
  const char* tricky = R"({"a": "\"policy\": {", "l": [{"policy": 1}], "p\u006flicy": {"mode": "ask"}, "z": "}"})";
  CHECK(with_member(tricky, "policy", Value{std::int64_t{7}}) ==
        R"({"a": "\"policy\": {", "l": [{"policy": 1}], "p\u006flicy": 7, "z": "}"})");
  CHECK(without_member(tricky, "z") ==
        R"({"a": "\"policy\": {", "l": [{"policy": 1}], "p\u006flicy": {"mode": "ask"}})");
  CHECK(without_member(tricky, "a") == R"({"l": [{"policy": 1}], "p\u006flicy": {"mode": "ask"}, "z": "}"})");
  CHECK(without_member("{\"a\": 1}", "a") == "{}");
  CHECK(without_member("{\"a\": 1}", "b") == "{\"a\": 1}");
  CHECK(with_member("{}", "b", Value{true}) == "{\n  \"b\": true\n}");
}

TEST_CASE("what is long has a line for each member") {
  const std::string out = edited_text(
      "", criteria, R"({"criteria": {"battery": {"weight": 1, "at_least": 20, "capabilities": ["move_base"]},
    "payload": {"weight": 2, "from": "description", "unit": "kg", "best": 10, "worst": 0, "capabilities": ["grab"]}}})");
  CHECK(out.find("\n    \"payload\": {") != std::string::npos);
  for (std::size_t at = 0; at < out.size();) {
    const std::size_t end = out.find('\n', at);
    CHECK(end - at <= 120);
    at = end + 1;
  }
}
