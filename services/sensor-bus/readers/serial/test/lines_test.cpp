#include "services/sensor-bus/readers/serial/lines.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::sensor;

namespace {

SensorRule line_rule(const std::string& channels, const std::string& more = "") {
  const auto json =
      parse_json(R"({"match": {"subsystem": "tty"}, "read": "line", )" + more + "\"sensors\": [" + channels + "]}");
  REQUIRE(json.ok());
  ConfigFaults faults;
  SensorRule rule = read_sensor_rule(*json, "r.json", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return rule;
}

/// The first channel's value in that line; "" for none, "!" for an error.
std::string value_of(const SensorRule& rule, std::string_view line) {
  const auto found = parse_line(rule, rule.channels[0], line);
  if (!found) return "!";
  if (!*found) return "";
  return (*found)->is_text ? (*found)->text : std::to_string((*found)->number);
}

}  // namespace

TEST_CASE("a line protocol's values: by pattern, by field, whole, as text") {
  CHECK(value_of(line_rule(R"j({"kind": "t", "pattern": "T=(-?[0-9.]+)"})j"), "T=21.5;H=40") == "21.500000");
  CHECK(value_of(line_rule(R"({"kind": "t", "field": 2})"), "a,-3.5,c") == "-3.500000");
  CHECK(value_of(line_rule(R"({"kind": "t", "field": 3})", R"("separator": ";", )"), "1;2;3") == "3.000000");
  CHECK(value_of(line_rule(R"({"kind": "t", "field": 4})"), "1,2,3") == "");
  CHECK(value_of(line_rule(R"({"kind": "t"})"), " 7 ") == "7.000000");
  CHECK(value_of(line_rule(R"({"kind": "t"})"), "seven") == "!");
  CHECK(value_of(line_rule(R"({"kind": "t", "field": 1})"), ",1") == "!");
  CHECK(value_of(line_rule(R"({"kind": "tag", "text": true})"),
                 "\x02"
                 "04A1\xff\x03") == "04A1?");
  CHECK(value_of(line_rule(R"({"kind": "tag", "text": true})"), "\x02 \x03") == "");
}

TEST_CASE("lines are cut from what comes in pieces; one that is too long is dropped to its end") {
  LineReader reader;
  std::vector<std::string> lines;
  const auto add = [&](std::string_view bytes) {
    reader.add(bytes, [&](std::string_view line) { lines.emplace_back(line); });
  };
  add("T=1");
  add(".5\r\n\r\nT=2\nT");
  CHECK(lines == std::vector<std::string>{"T=1.5", "T=2"});
  CHECK_FALSE(reader.take_too_long());
  for (int i = 0; i < 10'000; ++i) {
    add(std::string(1000, 'x'));
    REQUIRE(reader.held() <= LineReader::kMaxLine);
  }
  CHECK(reader.take_too_long());
  CHECK_FALSE(reader.take_too_long());
  add("tail\nT=3\n");
  CHECK(lines.back() == "T=3");
  CHECK(lines.size() == 3);
}
