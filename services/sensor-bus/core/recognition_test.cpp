#include "services/sensor-bus/core/recognition.hpp"

#include <doctest/doctest.h>

#include "common/config/sensor_files.hpp"
#include "tests/support/paths.hpp"

using namespace trb;
using namespace trb::sensor;

namespace {

std::vector<SensorRule> shipped() {
  ConfigFaults faults;
  auto rules = read_sensor_files(test::source_dir() + "/config", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return rules;
}

SensorRule rule_of(const std::string& text, const std::string& file = "sensors/mine.json") {
  const auto json = parse_json(text);
  REQUIRE_MESSAGE(json.ok(), text);
  ConfigFaults faults;
  SensorRule rule = read_sensor_rule(*json, file, faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults) << text);
  return rule;
}

Device iio(const std::string& number = "0") {
  return {"/sys/devices/i2c-1/1-005f/iio:device" + number,
          "iio",
          "iio_device",
          "iio:device" + number,
          "/dev/iio:device" + number,
          {{"DEVPATH", "/devices/i2c-1/1-005f/iio:device" + number}},
          {{"name", "hts221"}},
          {"name", "in_temp_raw", "in_temp_offset", "in_temp_scale", "in_humidityrelative_input", "uevent"}};
}

Device gps(const std::string& number = "0", const std::string& serial = "A1") {
  return {"/sys/devices/usb1/1-" + number + "/tty/ttyACM" + number,
          "tty",
          "",
          "ttyACM" + number,
          "/dev/ttyACM" + number,
          {{"ID_VENDOR_ID", "1546"},
           {"ID_MODEL_ID", "01a7"},
           {"ID_SERIAL_SHORT", serial},
           {"ID_BUS", "usb"},
           {"ID_VENDOR", "u-blox_AG"},
           {"ID_MODEL", "u-blox_7"},
           {"ID_PATH", "pci-usb-0:" + number}},
          {},
          {}};
}

Device stranger(const std::string& number = "0", const std::string& serial = "") {
  Device out = gps(number, serial);
  out.properties["ID_VENDOR_ID"] = "2341";
  out.properties["ID_MODEL"] = "Uno";
  if (serial.empty()) out.properties.erase("ID_SERIAL_SHORT");
  return out;
}

}  // namespace

TEST_CASE("an iio device's channels become sensors: the ready value if there is one, else raw, offset and scale") {
  Recognition recognition(shipped());
  const auto change = recognition.on_present(iio());
  REQUIRE(change.plugged.size() == 1);
  const auto& channels = change.plugged[0].channels;
  REQUIRE(channels.size() == 2);
  CHECK(channels[0].plugged.key == "/sys/devices/i2c-1/1-005f/iio:device0#in_temp");
  CHECK(channels[0].plugged.info.kind == "temperature");
  CHECK(channels[0].plugged.info.unit == "degC");
  CHECK(channels[0].plugged.info.device == "iio hts221");
  CHECK(channels[0].is_raw);
  CHECK(channels[1].attribute == "in_humidityrelative_input");
  CHECK_FALSE(channels[1].is_raw);
}

TEST_CASE("an attribute with '*' is a sensor for each file that is there") {
  Recognition recognition(shipped());
  const Device chip{"/sys/d/hwmon/hwmon1",
                    "hwmon",
                    "",
                    "hwmon1",
                    "",
                    {},
                    {{"name", "lm75"}},
                    {"temp1_input", "temp2_input", "temp1_max"}};
  const auto change = recognition.on_present(chip);
  REQUIRE(change.plugged.size() == 1);
  REQUIRE(change.plugged[0].channels.size() == 2);
  CHECK(change.plugged[0].channels[1].plugged.key == "/sys/d/hwmon/hwmon1#temp2_input");
}

TEST_CASE("the computer's own thermometer is no sensor of the robot's") {
  Recognition recognition(shipped());
  const Device cpu{"/sys/d/hwmon/hwmon0", "hwmon", "", "hwmon0", "", {}, {{"name", "coretemp"}}, {"temp1_input"}};
  CHECK(recognition.on_present(cpu).plugged.empty());
  CHECK(recognition.unknown().size() == 1);
}

TEST_CASE("the serial number of a device is the same wherever it is plugged in, each of its sensors apart") {
  Recognition recognition(shipped());
  const auto here = recognition.on_present(gps("0", "A1"));
  Recognition elsewhere(shipped());
  const auto there = elsewhere.on_present(gps("7", "A1"));
  REQUIRE(here.plugged.size() == 1);
  REQUIRE(there.plugged.size() == 1);
  const SensorInfo& info = here.plugged[0].channels[0].plugged.info;
  CHECK(info.identity == "1546:01a7:A1/position");
  CHECK(info.identity == there.plugged[0].channels[0].plugged.info.identity);
  CHECK(info.device == "u-blox AG u-blox 7");
  CHECK(here.plugged[0].channels[1].plugged.info.identity == "1546:01a7:A1/latitude");
}

TEST_CASE("a repeated event changes nothing, a change that matters plugs it anew") {
  Recognition recognition(shipped());
  CHECK(recognition.on_present(gps()).plugged.size() == 1);
  for (int i = 0; i < 3; ++i) {
    const auto again = recognition.on_present(gps());
    CHECK(again.plugged.empty());
    CHECK(again.unplugged.empty());
  }
  const auto change = recognition.on_present(gps("0", "B2"));
  CHECK(change.unplugged == std::vector<std::string>{gps().syspath});
  CHECK(change.plugged.size() == 1);
}

TEST_CASE("a device goes, once") {
  Recognition recognition(shipped());
  recognition.on_present(gps());
  CHECK(recognition.on_gone(gps().syspath).unplugged.size() == 1);
  CHECK(recognition.on_gone(gps().syspath).unplugged.empty());
  CHECK(recognition.present().empty());
}

TEST_CASE("a device that moves leaves its old path") {
  Recognition recognition(shipped());
  recognition.on_present(gps("0"));
  const auto change = recognition.on_moved(gps("0").syspath, gps("1"));
  CHECK(change.unplugged == std::vector<std::string>{gps("0").syspath});
  REQUIRE(change.plugged.size() == 1);
  CHECK(change.plugged[0].device.syspath == gps("1").syspath);
}

TEST_CASE("a hundred devices at once, each told twice") {
  Recognition recognition(shipped());
  std::size_t plugged = 0;
  for (int twice = 0; twice < 2; ++twice) {
    for (int i = 0; i < 100; ++i) plugged += recognition.on_present(iio(std::to_string(i))).plugged.size();
  }
  CHECK(plugged == 100);
  CHECK(recognition.present().size() == 100);
}

TEST_CASE("more devices than can be are refused and counted, and none that is known is lost") {
  Recognition recognition(shipped());
  for (std::size_t i = 0; i < Recognition::kMaxDevices + 5; ++i) recognition.on_present(iio(std::to_string(i)));
  CHECK(recognition.refused() == 5);
  CHECK(recognition.present().size() == Recognition::kMaxDevices);
  CHECK(recognition.on_gone(iio("3").syspath).unplugged.size() == 1);
  CHECK(recognition.on_present(iio("5000")).plugged.size() == 1);
}

TEST_CASE("of two rules the one that asks for more is taken, then the first by name") {
  auto rules = shipped();
  rules.push_back(
      rule_of(R"({"match": {"subsystem": "tty", "properties": {"ID_VENDOR_ID": "1546", "ID_SERIAL_SHORT": "A1"}},
                             "read": "nmea", "sensors": [{"kind": "speed", "value": "speed"}]})",
              "sensors/zz.json"));
  Recognition recognition(std::move(rules));
  const auto mine = recognition.on_present(gps("0", "A1"));
  const auto other = recognition.on_present(gps("1", "A2"));
  REQUIRE(mine.plugged.size() == 1);
  REQUIRE(other.plugged.size() == 1);
  CHECK(mine.plugged[0].rule->file == "sensors/zz.json");
  CHECK(other.plugged[0].rule->file == "sensors/gps.json");
}

TEST_CASE("an unknown device is listed with its properties and a rule that knows it and it alone") {
  const std::vector<Device> strangers = {
      stranger("1", "S1"),
      stranger("2", "S2"),
      stranger("3"),
      stranger("4"),
      {"/sys/devices/x/hwmon/hwmon3",
       "hwmon",
       "",
       "hwmon3",
       "",
       {{"DEVPATH", "/devices/x/hwmon/hwmon3"}},
       {{"name", "new"}},
       {"temp1_input", "fan1_input"}},
      {"/sys/devices/y/hwmon/hwmon4",
       "hwmon",
       "",
       "hwmon4",
       "",
       {{"DEVPATH", "/devices/y/hwmon/hwmon4"}},
       {{"name", "new"}},
       {"temp1_input"}},
      {"/sys/devices/z/iio:device1",
       "iio",
       "iio_device",
       "iio:device1",
       "",
       {{"DEVPATH", "/devices/z/iio:device1"}},
       {{"name", "adc"}},
       {"in_voltage0_raw", "in_voltage0_scale", "in_voltage0-voltage1_raw"}},
      {"/sys/bus/w1/2d-01", "w1", "", "2d-01", "", {{"DEVPATH", "/devices/w1/2d-01"}}, {}, {"id"}},
      {"/sys/devices/k/event3",
       "input",
       "",
       "event3",
       "/dev/input/event3",
       {{"ID_INPUT_KEYBOARD", "1"}, {"ID_BUS", "usb"}, {"ID_VENDOR_ID", "1111"}, {"ID_SERIAL_SHORT", "\"\\q"}},
       {},
       {}}};
  Recognition recognition(shipped());
  for (const Device& device : strangers) CHECK(recognition.on_present(device).unknown_changed);
  const auto unknown = recognition.unknown();
  REQUIRE(unknown.size() == strangers.size());
  for (const UnknownDevice& each : unknown) {
    const SensorRule rule = rule_of(each.rule);
    std::size_t matched = 0;
    for (const Device& device : strangers) {
      if (!matches(rule.matches[0], device)) continue;
      ++matched;
      CHECK(device.syspath == each.device);
      CHECK_MESSAGE(!find_sensors(device, std::make_shared<const SensorRule>(rule)).channels.empty(), each.rule);
    }
    CHECK_MESSAGE(matched == 1, each.rule);
  }
}

TEST_CASE("with its rule in place an unknown device is known") {
  Recognition before(shipped());
  before.on_present(stranger("1", "S1"));
  REQUIRE(before.unknown().size() == 1);
  CHECK(before.unknown()[0].properties.find("ID_MODEL=Uno") != std::string::npos);
  auto rules = shipped();
  rules.push_back(rule_of(before.unknown()[0].rule));
  Recognition after(std::move(rules));
  CHECK(after.on_present(stranger("1", "S1")).plugged.size() == 1);
  CHECK(after.unknown().empty());
}

TEST_CASE("what is no sensor is not listed") {
  Recognition recognition({});
  const Device console{"/sys/tty1", "tty", "", "tty1", "/dev/tty1", {}, {}, {}};
  const Device laptop{"/sys/event0",
                      "input",
                      "",
                      "event0",
                      "/dev/input/event0",
                      {{"ID_INPUT_KEYBOARD", "1"}, {"ID_BUS", "i8042"}},
                      {},
                      {}};
  const Device disk{"/sys/sda", "block", "disk", "sda", "/dev/sda", {}, {}, {}};
  for (const Device& each : {console, laptop, disk}) CHECK_FALSE(recognition.on_present(each).unknown_changed);
  CHECK(recognition.unknown().empty());
}

TEST_CASE("what is a part of a known device is not listed beside it") {
  Recognition recognition(shipped());
  const Device thermometer{"/sys/devices/w1/28-01", "w1", "", "28-01", "", {}, {{"name", "28-01"}}, {"w1_slave"}};
  const Device part{"/sys/devices/w1/28-01/hwmon/hwmon2", "hwmon",        "", "hwmon2", "", {},
                    {{"name", "w1_slave_temp"}},          {"temp1_input"}};
  recognition.on_present(part);
  CHECK(recognition.unknown().size() == 1);
  const auto change = recognition.on_present(thermometer);
  CHECK(change.unknown_changed);
  REQUIRE(change.plugged.size() == 1);
  CHECK(change.plugged[0].channels[0].plugged.info.identity == "28-01");
  CHECK(recognition.unknown().empty());
}

TEST_CASE("names of any bytes are told as text") {
  Recognition recognition(shipped());
  Device device = gps("0", "A\xff\x01");
  device.properties["ID_MODEL"] = "\xc3(GPS";
  const auto change = recognition.on_present(device);
  REQUIRE(change.plugged.size() == 1);
  for (const FoundChannel& channel : change.plugged[0].channels) {
    CHECK(is_utf8(channel.plugged.info.identity));
    CHECK(is_utf8(channel.plugged.info.device));
  }
  Device other = stranger("1", "S\xff");
  recognition.on_present(other);
  REQUIRE(recognition.unknown().size() == 1);
  CHECK(is_utf8(recognition.unknown()[0].properties));
  CHECK(is_utf8(recognition.unknown()[0].rule));
}

TEST_CASE("only what sensors are in is looked at, and what a rule names") {
  Recognition recognition({});
  CHECK_FALSE(recognition.subsystems().contains("block"));
  CHECK_FALSE(recognition.subsystems().contains("platform"));
  Recognition more([] {
    std::vector<SensorRule> rules;
    rules.push_back(
        rule_of(R"({"match": {"subsystem": "power_supply", "attributes": {"type": "Battery"}}, "read": "attributes",
                               "sensors": [{"kind": "charge", "attribute": "capacity"}]})"));
    return rules;
  }());
  CHECK(more.subsystems().contains("power_supply"));
  CHECK(more.attributes_of("power_supply").contains("type"));
}
