#include "common/fleet/sensor_rule.hpp"

#include <doctest/doctest.h>

#include "common/fleet/glob.hpp"

using namespace trb;

namespace {

SensorRule read_rule(const std::string& text, ConfigFaults& faults) {
  const auto json = parse_json(text);
  REQUIRE_MESSAGE(json.ok(), text);
  return read_sensor_rule(*json, "sensors/mine.json", faults);
}

/// The only fault of that file: "KEY: WHAT; CURE".
std::string fault_of(const std::string& text) {
  ConfigFaults faults;
  read_rule(text, faults);
  REQUIRE_MESSAGE(faults.size() == 1, to_text(faults));
  return faults[0].key + ": " + faults[0].what + "; " + faults[0].hint;
}

/// A thermometer on a serial line, with that instead of its pattern.
std::string thermometer(const std::string& how) {
  return R"({"match": {"subsystem": "tty"}, "read": "line", "sensors": [{"kind": "temperature", )" + how + "}]}";
}

}  // namespace

TEST_CASE("a glob means the whole text") {
  CHECK(glob_matches("28-*", "28-0000051"));
  CHECK(glob_matches("*:capture:*", ":capture:output:"));
  CHECK(glob_matches("temp?_input", "temp1_input"));
  CHECK(glob_matches("a*b*c", "a-b-b-c"));
  CHECK(glob_matches("", ""));
  CHECK(glob_matches("**", ""));
  CHECK_FALSE(glob_matches("28-*", "128-0"));
  CHECK_FALSE(glob_matches("temp?_input", "temp10_input"));
  CHECK_FALSE(glob_matches("a", ""));
}

TEST_CASE("a rule says which devices, and how each sensor is read") {
  ConfigFaults faults;
  const SensorRule rule = read_rule(R"j({
    "match": [{"subsystem": "tty", "properties": {"ID_VENDOR_ID": "10c4", "ID_MODEL": ["a*", "b"]}},
              {"subsystem": "tty", "devtype": "x", "sysname": "ttyACM*", "attributes": {"name": "n"}}],
    "read": "line", "baud": 115200, "separator": ";", "timeout_s": 2, "identity": {"property": "ID_SERIAL_SHORT"},
    "sensors": [{"kind": "temperature", "unit": "degC", "pattern": "T=([0-9.]+)", "every_s": 0.1, "scale": 0.5},
                {"kind": "tag", "name": "badge", "field": 2, "text": true}]})j",
                                    faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  REQUIRE(rule.matches.size() == 2);
  CHECK(rule.matches[0].properties[1].any_of == std::vector<std::string>{"a*", "b"});
  CHECK(rule.matches[0].conditions() == 2);
  CHECK(rule.matches[1].conditions() == 3);
  CHECK(rule.by == ReadBy::line);
  CHECK(rule.baud == 115200);
  CHECK(rule.separator == ';');
  REQUIRE(rule.channels.size() == 2);
  CHECK(rule.channels[0].name == "temperature");
  CHECK(rule.channels[0].every_s == 0.1);
  CHECK(rule.channels[0].pattern->find("x T=21.5;") == "21.5");
  CHECK(rule.channels[1].name == "badge");
  CHECK(rule.channels[1].every_s == 0);
  CHECK(*rule.channels[1].field == 2);
}

TEST_CASE("every fault of a rule is told at once, with its key and a cure") {
  ConfigFaults faults;
  read_rule(
      R"({"match": {"subsystm": "tty", "properties": {"A": 1, "B": []}}, "read": "line", "baud": 9601, "timeout_s": 0,
           "separator": "ab", "identity": {}, "camera": 1,
           "sensors": [{"kind": "room-temperature", "unit": 1}, {"name": "a", "kind": "b"}, {"name": "a", "kind": "c"}]})",
      faults);
  const std::string text = to_text(faults);
  for (const char* key :
       {"match.subsystem: is missing", "match.subsystm: is no key", "match.properties.A: is a whole number",
        "match.properties.B: is empty", "baud: 9601 is no speed", "timeout_s: 0 is out of range", "separator: 'ab'",
        "identity: must name one place", "camera: is no key", "sensors[0].kind: 'room-temperature' is no name",
        "sensors[0].unit: is a whole number", "sensors[2].name: 'a' occurs twice"}) {
    CHECK_MESSAGE(text.find(key) != std::string::npos, key << "\n" << text);
  }
  for (const ConfigFault& fault : faults) CHECK_MESSAGE(!fault.hint.empty(), fault.key);
}

TEST_CASE("what a reader does not take is refused") {
  CHECK(fault_of(R"({"match": {"subsystem": "iio"}, "read": "atributes", "sensors": []})")
            .ends_with("did you mean 'attributes'?"));
  CHECK(fault_of(R"({"match": {"subsystem": "iio"}, "read": "attributes",
                     "sensors": [{"kind": "k", "attribute": "../../x"}]})")
            .starts_with("sensors[0].attribute: '../../x' is no attribute"));
  CHECK(fault_of(R"({"match": {"subsystem": "iio"}, "read": "attributes", "sensors": [{"kind": "k"}]})")
            .starts_with("sensors[0].attribute: one of"));
  CHECK(fault_of(R"({"match": {"subsystem": "input"}, "read": "keyboard", "sensors": [{"kind": "tag", "every_s": 1}]})")
            .starts_with("sensors[0].every_s: is no key"));
  CHECK(fault_of(R"({"match": {"subsystem": "w1"}, "read": "w1", "sensors": [{"kind": "a"}, {"kind": "b"}]})")
            .starts_with("sensors: a device that is read by w1 is one sensor"));
  CHECK(fault_of(thermometer(R"j("pattern": "T", "field": 1)j")).starts_with("sensors[0].field: stands beside"));
}

TEST_CASE("a pattern that no line can be trusted with is refused") {
  CHECK(fault_of(thermometer(R"j("pattern": "(")j")).starts_with("sensors[0].pattern: is no regular expression"));
  CHECK(fault_of(thermometer(R"j("pattern": "(a)\\1")j")).starts_with("sensors[0].pattern: is no regular expression"));
  CHECK(fault_of(thermometer(R"j("pattern": "(a)(b)")j")).starts_with("sensors[0].pattern: has more than one group"));
  CHECK(fault_of(thermometer(R"j("pattern": "(?:a{9}){9}")j")).starts_with("sensors[0].pattern: repeats"));
  CHECK(fault_of(thermometer(R"j("pattern": ")j" + std::string(129, 'a') + "\""))
            .starts_with("sensors[0].pattern: is 129 bytes"));
}

TEST_CASE("a line of any length is searched in time that does not explode") {
  const auto pattern = LinePattern::make("(?:a+)+b");
  REQUIRE(pattern.ok());
  CHECK_FALSE(pattern->find(std::string(1024, 'a')).has_value());
  const auto deep = LinePattern::make("(?:(?:a?b?c?d?){8}e?f?g?h?i?j?k?l?m?n?o?p?){8}x");
  REQUIRE(deep.ok());
  CHECK_FALSE(deep->find(std::string(256, 'a')).has_value());
}

TEST_CASE("a file that is no rule at all has faults, and does no harm") {
  for (const char* text : {"{}", "[]", "1", R"({"match": []})", R"({"match": 1, "read": 1, "sensors": 1})"}) {
    ConfigFaults faults;
    read_rule(text, faults);
    CHECK(!faults.empty());
  }
}
