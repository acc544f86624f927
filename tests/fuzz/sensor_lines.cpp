// What sensors send: NMEA, lines of a protocol, 1-Wire thermometers, keys of a tag reader.
#include <cstring>

#include "services/sensor-bus/readers/attributes/w1_slave.hpp"
#include "services/sensor-bus/readers/keyboard/tag_keys.hpp"
#include "services/sensor-bus/readers/serial/lines.hpp"
#include "services/sensor-bus/readers/serial/nmea.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::sensor;

/// A rule of each kind of channel.
const SensorRule& rule() {
  static const SensorRule kRule = [] {
    const auto json = parse_json(R"j({"match": {"subsystem": "tty"}, "read": "line", "separator": ";", "sensors": [
      {"kind": "a", "pattern": "(?:^|[^A-Za-z])T=(-?[0-9.]+)"}, {"kind": "b", "field": 3}, {"kind": "c"},
      {"kind": "d", "pattern": "[0-9A-Fa-f]{4,16}", "text": true}, {"kind": "e", "text": true},
      {"kind": "f", "pattern": "(?:a?b?)*(?:x|xy)+z"}]})j");
    ConfigFaults faults;
    SensorRule out = read_sensor_rule(*json, "", faults);
    require(faults.empty(), "the rule is good");
    return out;
  }();
  return kRule;
}

void read_lines(BytesView input) {
  std::vector<std::string> whole;
  std::vector<std::string> pieces;
  LineReader one;
  LineReader two;
  one.add(input, [&](std::string_view line) { whole.emplace_back(line); });
  for (std::size_t i = 0; i < input.size(); ++i) {
    two.add(input.substr(i, 1), [&](std::string_view line) { pieces.emplace_back(line); });
    require(two.held() <= LineReader::kMaxLine, "what is held is bounded");
  }
  require(whole == pieces, "pieces read as the whole");
  for (const std::string& line : whole) {
    for (const SensorChannel& channel : rule().channels) {
      const auto found = parse_line(rule(), channel, line);
      if (!found || !*found) continue;
      require((*found)->is_text == channel.is_text, "a text is a text");
      require(is_utf8((*found)->text) && (*found)->text.size() <= 255, "a text is short and UTF-8");
    }
    const auto fix = parse_nmea(line);
    if (!fix || !fix->latitude) continue;
    require(fix->longitude.has_value(), "a place has two angles");
    require(*fix->latitude >= -90 && *fix->latitude <= 90 && *fix->longitude >= -180 && *fix->longitude <= 180,
            "a place is on the earth");
  }
}

/// The sentence with a correct checksum, so that the code behind the check is reached.
void read_sentence(BytesView input) {
  unsigned sum = 0;
  for (const char c : input) sum ^= static_cast<unsigned char>(c);
  const char* digits = "0123456789ABCDEF";
  const Bytes line = "$" + Bytes(input) + "*" + digits[sum / 16] + digits[sum % 16];
  require(parse_nmea(line).ok(), "a right checksum is right");
}

void press_keys(BytesView input) {
  TagKeys keys;
  for (std::size_t i = 0; i + 3 <= input.size(); i += 3) {
    std::uint16_t code = 0;
    std::memcpy(&code, input.data() + i, sizeof code);
    const auto tag = keys.add(static_cast<std::uint16_t>(code % 300), input[i + 2] % 3);
    require(keys.held() <= TagKeys::kMaxTag, "what is held is bounded");
    require(!tag || !tag->empty(), "a tag is not empty");
  }
}

}  // namespace

std::vector<Bytes> seeds() {
  return {"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n",
          "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n",
          "GPGLL,4916.45,N,12311.12,W,225444,A",
          "T=21.5;H=40;3\nT=-1;H=2;5.5\n",
          "72 01 4b 46 7f ff 0e 10 57 : crc=57 YES\n72 01 4b 46 7f ff 0e 10 57 t=23125\n",
          "\x02"
          "04A1B2C3\x03\r\n",
          Bytes("\x0b\x00\x01\x1c\x00\x01", 6),
          "abababxyxxyz\n"};
}

void run(BytesView input) {
  read_lines(input);
  read_sentence(input);
  press_keys(input);
  const auto value = parse_w1_slave(input);
  require(!value || std::abs(*value) < 1e308, "a temperature is finite");
}

}  // namespace trb::fuzz
