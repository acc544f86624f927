// Rules for sensors, and the devices to which they are applied: both contain any bytes.
#include <cstdio>

#include "services/sensor-bus/core/recognition.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::sensor;

constexpr const char* kUsual =
    R"j({"match": {"subsystem": "tty", "properties": {"ID_MODEL": ["*GPS*", "x"]}}, "read": "nmea",
  "baud": 4800, "identity": {"property": "ID_SERIAL_SHORT"}, "sensors": [{"kind": "speed", "unit": "m/s", "value": "speed"}]})j";

SensorRule read_rule(BytesView text, ConfigFaults& faults) {
  const auto json = parse_json(text);
  if (!json) {
    faults.push_back({});
    return {};
  }
  return read_sensor_rule(*json, "sensors/any.json", faults);
}

/// The device's names and values, from the input.
Device device_of(BytesView input, const char* subsystem) {
  Device device;
  device.syspath = "/sys/" + Bytes(input.substr(0, 100));
  device.subsystem = subsystem;
  device.sysname = "event" + Bytes(input.substr(0, 20));
  device.devnode = "/dev/x";
  for (const char* name : {"ID_MODEL", "ID_SERIAL_SHORT", "ID_PATH", "ID_V4L_CAPABILITIES"}) {
    device.properties[name] = Bytes(input.substr(0, 2000));
    if (!input.empty()) input.remove_prefix(1);
  }
  device.properties["ID_BUS"] = "usb";
  device.properties["ID_INPUT_KEYBOARD"] = "1";
  device.properties[Bytes(input)] = "";
  device.attribute_names = {"in_temp_raw", "in_" + Bytes(input.substr(0, 60)) + "_raw", "temp1_input",
                            Bytes(input.substr(0, 300)) + "_input"};
  return device;
}

void plug(Recognition& recognition, const Device& device) {
  const auto change = recognition.on_present(device);
  for (const FoundDevice& found : change.plugged) {
    require(!found.channels.empty(), "what is plugged in has sensors");
    for (const FoundChannel& channel : found.channels) {
      const SensorInfo& info = channel.plugged.info;
      require(info.identity.size() <= 128 && is_utf8(info.identity), "an identity is short and UTF-8");
      require(info.device.size() <= 128 && is_utf8(info.device), "a device's name is short and UTF-8");
    }
  }
  const auto again = recognition.on_present(device);
  require(again.plugged.empty() && again.unplugged.empty(), "a repeated event changes nothing");
  for (const UnknownDevice& unknown : recognition.unknown()) {
    require(is_utf8(unknown.properties) && unknown.properties.size() <= 4096, "properties are short and UTF-8");
    require(unknown.rule.size() <= 2048, "a rule is short");
    ConfigFaults faults;
    read_rule(unknown.rule, faults);
    if (!faults.empty()) std::fprintf(stderr, "%s\n%s\n", unknown.rule.c_str(), to_text(faults).c_str());
    require(faults.empty(), "the rule for an unknown device has no fault");
  }
  recognition.on_gone(device.syspath);
  require(recognition.present().empty(), "what is gone is gone");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {kUsual,
          R"j({"match": [{"subsystem": "iio", "attributes": {"name": "a?"}}], "read": "attributes",
            "sensors": [{"kind": "temperature", "channel": "in_temp", "scale": 0.001}]})j",
          R"j({"match": {"subsystem": "tty"}, "read": "line", "separator": ";", "sensors": [
            {"kind": "t", "pattern": "T=(-?[0-9.]{1,8})"}, {"kind": "tag", "field": 2, "text": true}]})j",
          R"j({"match": {"subsystem": "w1"}, "read": "w1", "sensors": [{"kind": "t"}]})j"};
}

void run(BytesView input) {
  ConfigFaults faults;
  SensorRule rule = read_rule(input, faults);
  for (const ConfigFault& fault : faults) require(fault.hint.empty() == fault.what.empty(), "a fault has a cure");
  std::vector<SensorRule> rules;
  if (faults.empty()) rules.push_back(std::move(rule));
  ConfigFaults none;
  rules.push_back(read_rule(kUsual, none));
  Recognition recognition(std::move(rules));
  for (const char* subsystem : {"tty", "input", "hwmon", "iio", "w1", "video4linux"}) {
    plug(recognition, device_of(input, subsystem));
  }
}

}  // namespace trb::fuzz
