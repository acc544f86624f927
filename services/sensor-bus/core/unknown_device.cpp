#include "services/sensor-bus/core/unknown_device.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "common/fleet/glob.hpp"
#include "proto/value.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxRuleSensors = 8;
constexpr std::size_t kMaxRuleSize = 2048;
constexpr std::size_t kMaxPattern = 255;
constexpr std::size_t kMaxPath = 512;
constexpr std::size_t kMaxProperties = 4096;

std::string quoted(const std::string& text) {
  return dump_json(Value{text});
}

bool has(const Device& device, const char* property) {
  const auto at = device.properties.find(property);
  return at != device.properties.end() && !at->second.empty();
}

bool is(const Device& device, const char* property, const char* pattern) {
  const auto at = device.properties.find(property);
  return at != device.properties.end() && glob_matches(pattern, at->second);
}

bool has_attribute(const Device& device, const char* pattern) {
  return std::any_of(device.attribute_names.begin(), device.attribute_names.end(),
                     [&](const std::string& name) { return glob_matches(pattern, name); });
}

/// The path, with '*' for the numbers that the kernel counts anew: ".../hwmon/hwmon*".
std::string lasting_path(const std::string& path) {
  std::size_t end = path.size();
  while (end > 0 && path[end - 1] >= '0' && path[end - 1] <= '9') --end;
  return end < path.size() ? path.substr(0, end) + "*" : path;
}

using Conditions = std::vector<std::pair<std::string, std::string>>;

/// What distinguishes it from every other device: its serial number, else where it is plugged in.
Conditions conditions_of(const Device& device) {
  Conditions out;
  const auto add = [&](const char* name) {
    if (!has(device, name)) return false;
    const std::string& value = device.properties.at(name);
    out.emplace_back(name, value.size() <= kMaxPattern ? value : cut_utf8(value, kMaxPattern - 1) + "*");
    return true;
  };
  add("ID_VENDOR_ID");
  add("ID_MODEL_ID");
  const bool one = add("ID_SERIAL_SHORT") || add("ID_PATH");
  add("ID_USB_INTERFACE_NUM");  // a device may have several ports
  if (!one && add("DEVPATH")) out.back().second = lasting_path(out.back().second);
  if (device.subsystem == "input") out.emplace_back("ID_INPUT_KEYBOARD", "1");
  if (device.subsystem == "video4linux") out.emplace_back("ID_V4L_CAPABILITIES", "*:capture:*");
  return out;
}

std::string match_of(const Device& device) {
  std::string out = "{ \"subsystem\": " + quoted(device.subsystem);
  if (!device.devtype.empty()) out += ", \"devtype\": " + quoted(device.devtype);
  const Conditions conditions = conditions_of(device);
  if (conditions.empty()) out += ", \"sysname\": " + quoted(device.sysname);
  const bool is_event = device.subsystem == "input" && device.sysname.starts_with("event");
  if (is_event && !conditions.empty()) out += R"(, "sysname": "event*")";
  if (!conditions.empty()) {
    std::string facts;
    for (const auto& [name, value] : conditions) {
      facts += (facts.empty() ? "" : ",\n      ") + quoted(name) + ": " + quoted(value);
    }
    out += ",\n    \"properties\": {\n      " + facts + " }";
  }
  return out + " }";
}

struct KnownFile {
  const char* pattern;
  const char* words;
};
/// hwmon: Documentation/hwmon/sysfs-interface; iio: Documentation/ABI/testing/sysfs-bus-iio.
constexpr KnownFile kHwmonFiles[] = {{"temp*_input", R"("kind": "temperature", "unit": "degC", "scale": 0.001)"},
                                     {"humidity*_input", R"("kind": "humidity", "unit": "percent", "scale": 0.001)"},
                                     {"in*_input", R"("kind": "voltage", "unit": "V", "scale": 0.001)"},
                                     {"curr*_input", R"("kind": "current", "unit": "A", "scale": 0.001)"},
                                     {"power*_input", R"("kind": "power", "unit": "W", "scale": 0.000001)"},
                                     {"fan*_input", R"("kind": "speed", "unit": "1/min")"}};
constexpr KnownFile kIioFiles[] = {{"in_temp*", R"("kind": "temperature", "unit": "degC", "scale": 0.001)"},
                                   {"in_humidity*", R"("kind": "humidity", "unit": "percent", "scale": 0.001)"},
                                   {"in_pressure*", R"("kind": "pressure", "unit": "Pa", "scale": 1000)"},
                                   {"in_illuminance*", R"("kind": "illuminance", "unit": "lx")"},
                                   {"in_distance*", R"("kind": "distance", "unit": "m")"},
                                   {"in_voltage*", R"("kind": "voltage", "unit": "V", "scale": 0.001)"},
                                   {"in_current*", R"("kind": "current", "unit": "A", "scale": 0.001)"},
                                   {"in_accel*", R"("kind": "acceleration", "unit": "m/s2")"},
                                   {"in_anglvel*", R"("kind": "turn", "unit": "rad/s")"},
                                   {"in_*", R"("kind": "value")"}};

template <std::size_t N>
std::string words_of(const KnownFile (&files)[N], const std::string& name) {
  for (const KnownFile& file : files) {
    if (glob_matches(file.pattern, name)) return file.words;
  }
  return {};
}

/// Kernels name their files in ASCII.
bool is_plain(const std::string& name) {
  const auto good = [](char c) { return c > ' ' && c < 0x7f; };
  return name.size() <= 60 && name.find("..") == std::string::npos && std::all_of(name.begin(), name.end(), good);
}

/// A name of letters, digits and '_', as a sensor's must be.
std::string as_name(const std::string& text) {
  std::string out = text;
  for (char& c : out) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!good) c = '_';
  }
  return out;
}

/// The entries of "sensors".
class Entries {
 public:
  void add(const std::string& file, const std::string& words, const std::string& key) {
    const std::string name = as_name(file);
    if (words.empty() || !is_plain(file) || names_.size() >= kMaxRuleSensors || !names_.insert(name).second) return;
    text_ += std::string(text_.empty() ? "" : ",\n    ") + "{ \"name\": " + quoted(name) + ", " + words + ", \"" + key +
             "\": " + quoted(file) + " }";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::set<std::string> names_;
  std::string text_;
};

std::string hwmon_sensors(const Device& device) {
  Entries entries;
  for (const std::string& name : device.attribute_names) {
    if (name.ends_with("_input")) entries.add(name, words_of(kHwmonFiles, name), "attribute");
  }
  return entries.text();
}

std::string iio_sensors(const Device& device) {
  Entries entries;
  for (const std::string& name : device.attribute_names) {
    if (!name.ends_with("_input") && !name.ends_with("_raw")) continue;
    const std::string channel = name.substr(0, name.rfind('_'));
    entries.add(channel, words_of(kIioFiles, channel), "channel");
  }
  return entries.text();
}

/// How such devices are usually read.
std::string reading_of(const Device& device) {
  const auto attributes = [](const std::string& sensors) {
    return "\"read\": \"attributes\",\n  \"sensors\": [\n    " +
           (sensors.empty() ? R"({ "kind": "value", "attribute": "FILE" })" : sensors) + " ]";
  };
  if (device.subsystem == "hwmon") return attributes(hwmon_sensors(device));
  if (device.subsystem == "iio") return attributes(iio_sensors(device));
  if (device.subsystem == "w1") {
    return R"("read": "w1",
  "sensors": [{ "kind": "temperature", "unit": "degC", "scale": 0.001 }])";
  }
  if (device.subsystem == "input") return "\"read\": \"keyboard\",\n  \"sensors\": [{ \"kind\": \"tag\" }]";
  if (device.subsystem == "video4linux") {
    return "\"read\": \"camera\",\n  \"sensors\": [{ \"kind\": \"image\", \"name\": \"camera\" }]";
  }
  if (device.subsystem != "tty") return attributes({});
  return R"j("read": "line",
  "baud": 9600,
  "sensors": [{ "kind": "temperature", "unit": "degC", "pattern": "T=(-?[0-9.]+)" }])j";
}

std::string rule_of(const Device& device) {
  std::string out = "{\n  \"match\": " + match_of(device) + ",\n";
  if (has(device, "ID_SERIAL_SHORT")) out += "  \"identity\": { \"property\": \"ID_SERIAL_SHORT\" },\n";
  out += "  " + reading_of(device) + "\n}\n";
  if (out.size() <= kMaxRuleSize) return out;
  return "{\n  \"match\": { \"subsystem\": " + quoted(device.subsystem) + ", \"sysname\": " + quoted(device.sysname) +
         " },\n  " + reading_of(Device{{}, device.subsystem, {}, {}, {}, {}, {}, {}}) + "\n}\n";
}

/// Of the moment at which it was told, not of the device.
bool is_of_event(std::string_view name) {
  return name == "ACTION" || name == "SEQNUM" || name == "USEC_INITIALIZED" || name == "CURRENT_TAGS";
}

}  // namespace

bool is_worth_listing(const Device& device) {
  const std::string& kind = device.subsystem;
  if (kind == "tty") return !device.devnode.empty() && (has(device, "ID_BUS") || has(device, "ID_VENDOR_ID"));
  if (kind == "input") {
    return !device.devnode.empty() && device.sysname.starts_with("event") && is(device, "ID_INPUT_KEYBOARD", "1") &&
           (is(device, "ID_BUS", "usb") || is(device, "ID_BUS", "bluetooth"));
  }
  if (kind == "video4linux") return is(device, "ID_V4L_CAPABILITIES", "*:capture:*");
  if (kind == "iio") return device.devtype == "iio_device" && has_attribute(device, "in_*");
  if (kind == "hwmon") return has_attribute(device, "*_input");
  if (kind == "w1") return device.sysname.size() > 3 && device.sysname[2] == '-';
  return true;  // a rule names its subsystem, and the rule does not fit
}

UnknownDevice describe_unknown(const Device& device) {
  UnknownDevice out;
  out.device = cut_utf8(device.syspath, kMaxPath);
  for (const auto& [name, value] : device.properties) {
    if (is_of_event(name)) continue;
    out.properties.append(name).append("=").append(value) += '\n';
  }
  if (!out.properties.empty()) out.properties.pop_back();
  out.properties = cut_utf8(out.properties, kMaxProperties);
  out.rule = rule_of(device);
  return out;
}

}  // namespace trb::sensor
