#include <doctest/doctest.h>
#include <linux/input-event-codes.h>

#include <array>
#include <cstdio>

#include "services/sensor-bus/core/nmea.hpp"
#include "services/sensor-bus/core/tag_keys.hpp"

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

/// The sentence with its checksum.
std::string sentence(std::string_view body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  std::array<char, 3> digits{};
  std::snprintf(digits.data(), digits.size(), "%02X", sum & 0xffU);
  return "$" + std::string(body) + "*" + digits.data();
}

}  // namespace

TEST_CASE("a number is all of the text, or none") {
  CHECK(*parse_number(" 21500\n") == 21500);
  CHECK(*parse_number("-0.5e1") == -5);
  CHECK(*parse_number("+3") == 3);
  for (const char* text : {"", "\n", "21,5", "21 5", "nan", "inf", "0x10", "1e999", "+-1", "T"}) {
    CHECK_MESSAGE(!parse_number(text).ok(), text);
  }
}

TEST_CASE("a 1-Wire thermometer is believed if its checksum is right") {
  CHECK(*parse_w1_slave("72 01 4b 46 7f ff 0e 10 57 : crc=57 YES\n72 01 4b 46 7f ff 0e 10 57 t=23125\n") == 23125);
  CHECK(*parse_w1_slave("x : crc=57 YES\nx t=-62\n") == -62);
  for (const char* text : {"", "x : crc=57 NO\nx t=23125\n", "x : crc=57 YES\n", "x : crc=57 YES\nx t=\n",
                           "crc=0 YES t=1", "x : crc=57 YES\nx t=85000\n"}) {
    CHECK_MESSAGE(!parse_w1_slave(text).ok(), text);
  }
}

TEST_CASE("NMEA tells where a receiver is") {
  const auto gga = parse_nmea("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47");
  REQUIRE(gga.ok());
  CHECK(*gga->latitude == doctest::Approx(48.1173));
  CHECK(*gga->longitude == doctest::Approx(11.516667));
  CHECK(*gga->altitude == doctest::Approx(545.4));
  CHECK(*gga->satellites == 8);
  CHECK(gga->value(NmeaValue::position)->text == "48.1173000,11.5166667");
  const auto rmc = parse_nmea("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A");
  REQUIRE(rmc.ok());
  CHECK(*rmc->speed == doctest::Approx(11.5236));
  CHECK(*rmc->course == doctest::Approx(84.4));
}

TEST_CASE("an NMEA sentence without a fix tells nothing, a wrong one is an error") {
  const auto none = parse_nmea(sentence("GPGGA,123519,,,,,0,00,,,M,,M,,"));
  CHECK((none && none->none));
  REQUIRE_MESSAGE(none.ok(), none.error().text());
  CHECK_FALSE(none->value(NmeaValue::position).has_value());
  CHECK_FALSE(none->value(NmeaValue::altitude).has_value());
  for (const char* text : {"", "$", "$*", "$*0", "GPGGA,1*00", "$GPGGA,1", "$GPGGA,1*zz",
                           "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*48"}) {
    CHECK_MESSAGE(!parse_nmea(text).ok(), text);
  }
  // The checksum is right; the minutes, the side or the degrees are not.
  for (const char* body :
       {"GPGLL,4860.0,N,01131.0,E,1,A", "GPGLL,4807.0,X,01131.0,E,1,A", "GPGLL,9107.0,N,01131.0,E,1,A",
        "GPGLL,4807.0,N,18131.0,E,1,A", "GPGLL,4807.0,N,01131.0,E,1,V"}) {
    const auto fix = parse_nmea(sentence(body));
    REQUIRE(fix.ok());
    CHECK_MESSAGE(!fix->latitude.has_value(), body);
  }
}

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

TEST_CASE("keys become a tag at Enter") {
  TagKeys keys;
  const auto press = [&](std::uint16_t code) {
    const auto tag = keys.add(code, 1);
    keys.add(code, 0);
    return tag;
  };
  for (const int code : {KEY_0, KEY_4, KEY_F}) CHECK_FALSE(press(static_cast<std::uint16_t>(code)).has_value());
  keys.add(KEY_LEFTSHIFT, 1);
  press(KEY_A);
  keys.add(KEY_A, 2);  // repeated: the same key
  keys.add(KEY_LEFTSHIFT, 0);
  press(KEY_F5);
  press(KEY_KP1);
  CHECK(press(KEY_ENTER) == "04fA1");
  CHECK_FALSE(press(KEY_ENTER).has_value());
  for (std::size_t i = 0; i < 2 * TagKeys::kMaxTag; ++i) press(KEY_1);
  CHECK(keys.held() <= TagKeys::kMaxTag);
  CHECK_FALSE(press(KEY_ENTER).has_value());
  press(KEY_7);
  CHECK(press(KEY_KPENTER) == "7");
}
