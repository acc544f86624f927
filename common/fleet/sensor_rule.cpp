#include "common/fleet/sensor_rule.hpp"

#include <algorithm>

#include "common/base/sensor_name.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxMatches = 16;
constexpr std::size_t kMaxConditions = 16;
constexpr std::size_t kMaxPatterns = 64;
constexpr std::size_t kMaxChannels = 32;
constexpr std::size_t kMaxName = 64;
constexpr std::size_t kMaxText = 255;
constexpr Range kPeriod{0.01, 3600.0};
constexpr double kUsualTimeout = 3;

/// A file in the device's own folder; the path cannot leave it.
bool is_attribute(std::string_view name) {
  return !name.empty() && name.front() != '/' && name.find("..") == std::string_view::npos &&
         name.find('\0') == std::string_view::npos;
}

void check_attribute(ObjectReader& reader, std::string_view key, const std::string& name) {
  if (name.empty() || is_attribute(name)) return;
  reader.faults().add(reader.path(key), in_quotes(name) + " is no attribute",
                      "use the name of a file in the device's folder below /sys, for example temp1_input");
}

/// A text, or a list of them.
std::vector<std::string> read_patterns(ObjectReader& reader, const std::string& key) {
  const Value* value = reader.value(key, Need::optional);
  if (value == nullptr) return {};
  if (value->is_list()) {
    auto texts = reader.texts(key, Need::optional, kMaxPatterns);
    if (value->list().empty()) {
      reader.faults().add(reader.path(key), "is empty, so no device is meant", "name what it may be, or remove it");
    }
    return texts;
  }
  const auto text = reader.text(key, Need::optional, kMaxText);
  return text ? std::vector<std::string>{*text} : std::vector<std::string>{};
}

std::vector<TextMatch> read_conditions(ObjectReader& match, const std::string& key, bool attributes) {
  std::vector<TextMatch> out;
  const auto* members = match.object(key, Need::optional, kMaxConditions);
  if (members == nullptr) return out;
  ObjectReader reader(*match.value(key, Need::optional), match.path(key), match.faults());
  for (const auto& [name, ignored] : *members) {
    if (attributes) check_attribute(reader, name, name);
    out.push_back({name, read_patterns(reader, name)});
  }
  return out;
}

DeviceMatch read_match(const Value& json, const std::string& path, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  DeviceMatch match;
  match.subsystem = reader.text("subsystem", Need::required, kMaxName).value_or("");
  match.devtype = reader.text("devtype", Need::optional, kMaxName).value_or("");
  match.sysname = read_patterns(reader, "sysname");
  match.properties = read_conditions(reader, "properties", false);
  match.attributes = read_conditions(reader, "attributes", true);
  reader.refuse_unknown_keys();
  return match;
}

std::vector<DeviceMatch> read_matches(ObjectReader& rule) {
  const Value* json = rule.value("match", Need::required);
  if (json == nullptr) return {};
  if (!json->is_list()) return {read_match(*json, "match", rule.faults())};
  std::vector<DeviceMatch> out;
  if (!check_count(rule.faults(), "match", json->list().size(), kMaxMatches)) return out;
  for (const Value& each : json->list()) {
    out.push_back(read_match(each, "match[" + std::to_string(out.size()) + "]", rule.faults()));
  }
  if (out.empty()) rule.faults().add("match", "is empty, so no device is meant", R"(write {"subsystem": …})");
  return out;
}

std::optional<IdentitySource> read_identity(ObjectReader& rule) {
  const Value* json = rule.value("identity", Need::optional);
  if (json == nullptr) return std::nullopt;
  ObjectReader reader(*json, "identity", rule.faults());
  const auto property = reader.text("property", Need::optional, kMaxText);
  const auto attribute = reader.text("attribute", Need::optional, kMaxText);
  if (attribute) check_attribute(reader, "attribute", *attribute);
  reader.refuse_unknown_keys();
  if (property.has_value() == attribute.has_value()) {
    if (!json->is_object()) return std::nullopt;
    rule.faults().add("identity", "must name one place", R"(write {"property": NAME} or {"attribute": NAME})");
    return std::nullopt;
  }
  return IdentitySource{property.has_value(), property ? *property : *attribute};
}

void read_attribute_channel(ObjectReader& reader, SensorChannel& channel) {
  channel.attribute = reader.text("attribute", Need::optional, kMaxText).value_or("");
  channel.channel = reader.text("channel", Need::optional, kMaxName).value_or("");
  check_attribute(reader, "attribute", channel.attribute);
  check_attribute(reader, "channel", channel.channel);
  if (reader.is_object() && channel.attribute.empty() == channel.channel.empty()) {
    reader.faults().add(reader.path("attribute"), "one of \"attribute\" and \"channel\" is needed",
                        R"(write "attribute": "temp1_input", or "channel": "in_temp" for an iio device)");
  }
}

void read_line_channel(ObjectReader& reader, SensorChannel& channel) {
  const auto pattern = reader.text("pattern", Need::optional);
  const auto field = reader.integer("field", Need::optional, 1, 64);
  channel.is_text = reader.boolean("text", Need::optional).value_or(false);
  if (field) channel.field = static_cast<std::size_t>(*field);
  if (pattern && field) {
    reader.faults().add(reader.path("field"), "stands beside \"pattern\"", "keep one of them");
  }
  if (!pattern) return;
  auto made = LinePattern::make(*pattern);
  if (!made) return reader.faults().add(reader.path("pattern"), made.error().what, made.error().hint);
  channel.pattern = std::move(*made);
}

void read_how(ObjectReader& reader, ReadBy by, SensorChannel& channel) {
  if (by == ReadBy::attributes) read_attribute_channel(reader, channel);
  if (by == ReadBy::line) read_line_channel(reader, channel);
  if (by == ReadBy::nmea)
    channel.nmea = reader.one_of<NmeaValue>("value", Need::required).value_or(NmeaValue::position);
}

bool is_text(ReadBy by, const SensorChannel& channel) {
  return channel.is_text || (by == ReadBy::nmea && channel.nmea == NmeaValue::position);
}

/// A sensor that sends only when there is something has no period.
bool has_no_period(ReadBy by, const SensorChannel& channel) {
  return !kind_of(by).period || (by == ReadBy::line && channel.is_text);
}

void check_name(ObjectReader& reader, std::string_view key, const std::string& name) {
  if (name.empty() || is_sensor_name(name)) return;
  reader.faults().add(reader.path(key), in_quotes(name) + " is no name",
                      "start with a letter or '_'; then letters, digits or '_'");
}

SensorChannel read_channel(const Value& json, const std::string& path, ReadBy by, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  SensorChannel channel;
  channel.kind = reader.text("kind", Need::required, kMaxName).value_or("");
  channel.name = reader.text("name", Need::optional, kMaxName).value_or(channel.kind);
  check_name(reader, "kind", channel.kind);
  if (channel.name != channel.kind) check_name(reader, "name", channel.name);
  channel.unit = reader.text("unit", Need::optional, 16).value_or("");
  read_how(reader, by, channel);
  channel.every_s = has_no_period(by, channel) ? 0 : 1;
  if (kind_of(by).period) {
    channel.every_s = reader.number("every_s", Need::optional, kPeriod).value_or(channel.every_s);
  }
  if (kind_of(by).period && !is_text(by, channel)) {
    channel.scale = reader.number("scale", Need::optional).value_or(1);
    channel.offset = reader.number("offset", Need::optional).value_or(0);
  }
  reader.refuse_unknown_keys();
  return channel;
}

void read_channels(ObjectReader& rule, SensorRule& out) {
  const auto* items = rule.list("sensors", Need::required, kMaxChannels);
  if (items == nullptr) return;
  if (items->empty()) rule.faults().add("sensors", "is empty", R"(write [{"kind": "temperature", "unit": "degC", …}])");
  for (const Value& each : *items) {
    const std::string path = "sensors[" + std::to_string(out.channels.size()) + "]";
    SensorChannel channel = read_channel(each, path, out.by, rule.faults());
    const bool again = std::any_of(out.channels.begin(), out.channels.end(),
                                   [&](const SensorChannel& other) { return other.name == channel.name; });
    if (again && !channel.name.empty()) {
      rule.faults().add(path + ".name", in_quotes(channel.name) + " occurs twice", "give each sensor its own \"name\"");
    }
    out.channels.push_back(std::move(channel));
  }
  if (kind_of(out.by).one_sensor && out.channels.size() > 1) {
    rule.faults().add("sensors", "a device that is read by " + std::string(name_of(out.by)) + " is one sensor",
                      "keep one of them");
  }
}

void read_serial(ObjectReader& rule, SensorRule& out) {
  const auto baud = rule.integer("baud", Need::optional, 1, 4'000'000).value_or(out.by == ReadBy::nmea ? 4800 : 9600);
  const auto& known = serial_speeds();
  if (std::find(known.begin(), known.end(), baud) == known.end()) {
    rule.faults().add("baud", std::to_string(baud) + " is no speed of a serial line",
                      "use what the device's manual says, for example 9600 or 115200");
  }
  out.baud = static_cast<std::uint32_t>(baud);
  if (out.by != ReadBy::line) return;
  const auto separator = rule.text("separator", Need::optional, 8);
  if (!separator) return;
  if (separator->size() == 1 && *separator != "\n")
    out.separator = separator->front();
  else
    rule.faults().add("separator", in_quotes(*separator) + " is no single character", "use for example \";\"");
}

void read_camera(ObjectReader& rule, SensorRule& out) {
  out.width = static_cast<std::uint32_t>(rule.integer("width", Need::optional, 16, 1920).value_or(640));
  out.height = static_cast<std::uint32_t>(rule.integer("height", Need::optional, 16, 1080).value_or(480));
}

}  // namespace

std::size_t DeviceMatch::conditions() const {
  return properties.size() + attributes.size() + (devtype.empty() ? 0 : 1) + (sysname.empty() ? 0 : 1);
}

const std::vector<std::int64_t>& serial_speeds() {
  static const std::vector<std::int64_t> kSpeeds = {1200,  2400,   4800,   9600,   19200,  38400,
                                                    57600, 115200, 230400, 460800, 921600, 1'000'000};
  return kSpeeds;
}

SensorRule read_sensor_rule(const Value& json, const std::string& file, ConfigFaults& faults) {
  ObjectReader reader(json, "", {file, faults});
  SensorRule rule;
  rule.file = file;
  rule.matches = read_matches(reader);
  const auto by = reader.one_of<ReadBy>("read", Need::required);
  rule.by = by.value_or(ReadBy::attributes);
  rule.timeout_s = reader.number("timeout_s", Need::optional, {0.1, 60}).value_or(kUsualTimeout);
  if (rule.by == ReadBy::nmea || rule.by == ReadBy::line) read_serial(reader, rule);
  if (rule.by == ReadBy::camera) read_camera(reader, rule);
  rule.identity = read_identity(reader);
  // Its sensors can be checked only if it is known how it is read.
  if (by || reader.value("read", Need::optional) == nullptr) read_channels(reader, rule);
  if (by) reader.refuse_unknown_keys();
  return rule;
}

}  // namespace trb
