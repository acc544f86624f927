// The "faults" and "sensors" of a description.
#include <doctest/doctest.h>

#include "common/fleet/description.hpp"

using namespace trb;

namespace {

struct Read {
  Description description;
  ConfigFaults faults;
};

/// A description with those faults.
Read read(const std::string& rules, const std::string& sensors = "[]") {
  Read out;
  const std::string text = R"({"maker": "m", "model": "m", "capabilities": ["mobile", "grab"], "skills": {},
    "faults": {)" + rules + R"(}, "sensors": )" +
                           sensors + "}";
  out.description = read_description(*parse_json(text), "robots/r.json", out.faults);
  return out;
}

FaultRule good(const std::string& rule) {
  const Read out = read("\"f\": " + rule);
  REQUIRE_MESSAGE(out.faults.empty(), to_text(out.faults));
  return out.description.faults.at(0);
}

void check_bad(const std::string& rule, const std::string& key, const std::string& what) {
  CAPTURE(rule);
  const Read out = read("\"f\": " + rule);
  REQUIRE_MESSAGE(out.faults.size() == 1, to_text(out.faults));
  CHECK(out.faults[0].key == key);
  CHECK_MESSAGE(out.faults[0].what.find(what) != std::string::npos, out.faults[0].what);
  CHECK_FALSE(out.faults[0].hint.empty());
}

}  // namespace

TEST_CASE("a fault has a value, one condition and a severity; capability and text where they are given") {
  const FaultRule low = good(
      R"({"value": "battery", "below": 20, "severity": "WARNING", "capability": "mobile", "text": "battery is low"})");
  CHECK(low.name == "f");
  CHECK(low.value == "battery");
  CHECK(low.when == FaultWhen::below);
  CHECK(low.limit == 20);
  CHECK(low.rearm == doctest::Approx(21));
  CHECK(low.severity == Severity::warning);
  CHECK(low.capability == "mobile");
  CHECK(low.text == "battery is low");
  const FaultRule hot = good(R"({"value": "t", "above": -10, "severity": "FATAL"})");
  CHECK(hot.rearm == doctest::Approx(-10.5));
  CHECK(hot.capability.empty());
  CHECK(good(R"({"value": "t", "above": 70, "rearm": 60, "severity": "FATAL"})").rearm == 60);
  CHECK(good(R"({"value": "s", "equals": "stuck", "severity": "URGENT"})").wanted == Value{std::string("stuck")});
  CHECK(good(R"({"value": "s", "equals": false, "severity": "URGENT"})").wanted == Value{false});
  CHECK(good(R"({"value": "s", "changes": true, "severity": "CRITICAL"})").when == FaultWhen::changes);
}

TEST_CASE("what is wrong with a fault is told with its key and a cure") {
  check_bad(R"({"value": "b", "severity": "WARNING"})", "faults.f", "no condition");
  check_bad(R"({"value": "b", "below": 1, "above": 2, "severity": "WARNING"})", "faults.f", "more than one condition");
  check_bad(R"({"value": "b", "below": 20, "rearm": 19, "severity": "WARNING"})", "faults.f.rearm", "lies where");
  check_bad(R"({"value": "b", "above": 20, "rearm": 21, "severity": "WARNING"})", "faults.f.rearm", "lies where");
  check_bad(R"({"value": "b", "equals": 1, "rearm": 2, "severity": "WARNING"})", "faults.f.rearm", "no key");
  check_bad(R"({"value": "b", "equals": [1], "severity": "WARNING"})", "faults.f.equals", "is a list");
  check_bad(R"({"value": "b", "below": "20", "severity": "WARNING"})", "faults.f.below", "is a text");
  check_bad(R"({"value": "b", "changes": false, "severity": "WARNING"})", "faults.f.changes", "is false");
  check_bad(R"({"value": "b", "below": 20})", "faults.f.severity", "is missing");
  check_bad(R"({"value": "b", "below": 20, "severity": "BAD"})", "faults.f.severity", "'BAD'");
  check_bad(R"({"below": 20, "severity": "WARNING"})", "faults.f.value", "is missing");
  check_bad(R"({"value": "b", "below": 20, "severity": "WARNING", "capability": "mobil"})", "faults.f.capability",
            "not among");
  check_bad(R"({"value": "b", "below": 20, "severity": "WARNING", "cap": "x"})", "faults.f.cap", "no key");
  check_bad("7", "faults.f", "");
}

TEST_CASE("sensors are names of values") {
  CHECK(read("", R"(["battery", "safety"])").description.sensors == std::vector<std::string>{"battery", "safety"});
  CHECK(read("", R"(["a b"])").faults.at(0).key == "sensors");
}
