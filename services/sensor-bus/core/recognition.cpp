#include "services/sensor-bus/core/recognition.hpp"

#include <algorithm>

#include "common/fleet/glob.hpp"
#include "services/sensor-bus/core/unknown_device.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxUnknown = 64;
constexpr std::size_t kMaxSensorsOfDevice = 64;

bool any_matches(const std::vector<std::string>& patterns, const std::string& text) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& p) { return glob_matches(p, text); });
}

bool all_hold(const std::vector<TextMatch>& conditions, const std::map<std::string, std::string>& facts) {
  return std::all_of(conditions.begin(), conditions.end(), [&](const TextMatch& condition) {
    const auto fact = facts.find(condition.name);
    return fact != facts.end() && any_matches(condition.any_of, fact->second);
  });
}

std::string property(const Device& device, const std::string& name) {
  const auto at = device.properties.find(name);
  return at == device.properties.end() ? std::string() : at->second;
}

/// Two makers may give the same serial number.
std::string identity_of(const Device& device, const SensorRule& rule) {
  if (!rule.identity) return {};
  const auto& facts = rule.identity->is_property ? device.properties : device.attributes;
  const auto at = facts.find(rule.identity->name);
  if (at == facts.end() || at->second.empty()) return {};
  const std::string vendor = property(device, "ID_VENDOR_ID");
  return vendor.empty() ? at->second : vendor + ":" + property(device, "ID_MODEL_ID") + ":" + at->second;
}

/// udev writes '_' for what a name may not have.
std::string readable(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// What the device calls itself; where that is only a number, what udev's database does.
std::string part_of_name(const Device& device, const std::string& part) {
  const std::string own = property(device, "ID_" + part);
  if (!own.empty() && own != property(device, "ID_" + part + "_ID")) return readable(own);
  const std::string known = property(device, "ID_" + part + "_FROM_DATABASE");
  return known.empty() ? own : known;
}

/// Maker and model, for people.
std::string name_of_device(const Device& device) {
  const std::string maker = part_of_name(device, "VENDOR");
  const std::string model = part_of_name(device, "MODEL");
  if (!maker.empty() && !model.empty() && !model.starts_with(maker)) return maker + " " + model;
  if (!maker.empty() || !model.empty()) return model.empty() ? maker : model;
  const auto name = device.attributes.find("name");
  return name == device.attributes.end() ? device.sysname : device.subsystem + " " + name->second;
}

FoundChannel make_channel(const Device& device, const SensorChannel& how, const std::string& mark,
                          const std::string& identity) {
  FoundChannel out;
  out.how = &how;
  out.plugged.key = device.syspath + "#" + mark;
  out.plugged.every_s = how.every_s;
  SensorInfo& info = out.plugged.info;
  info.name = how.name;
  info.kind = how.kind;
  info.unit = how.unit;
  info.identity = cut_utf8(identity, 128);
  info.device = cut_utf8(name_of_device(device), 128);
  return out;
}

/// The files of an attribute that are there; each is a sensor.
void find_attributes(FoundDevice& found, const SensorChannel& how, const std::string& identity) {
  for (const std::string& name : found.device.attribute_names) {
    if (found.channels.size() >= kMaxSensorsOfDevice || !glob_matches(how.attribute, name)) continue;
    found.channels.push_back(make_channel(found.device, how, name, identity));
    found.channels.back().attribute = name;
  }
}

void find_iio_channel(FoundDevice& found, const SensorChannel& how, const std::string& identity) {
  const auto& names = found.device.attribute_names;
  const bool ready = names.contains(how.channel + "_input");
  if (!ready && !names.contains(how.channel + "_raw")) return;
  FoundChannel channel = make_channel(found.device, how, how.channel, identity);
  channel.attribute = ready ? how.channel + "_input" : how.channel;
  channel.is_raw = !ready;
  found.channels.push_back(std::move(channel));
}

/// A device's sensors differ in their identity, too.
void distinguish_sensors(FoundDevice& found) {
  if (found.channels.size() < 2) return;
  for (FoundChannel& channel : found.channels) {
    SensorInfo& info = channel.plugged.info;
    if (info.identity.empty()) continue;
    const std::string mark = channel.plugged.key.substr(channel.plugged.key.rfind('#') + 1);
    info.identity = cut_utf8(info.identity, 127 - std::min<std::size_t>(mark.size(), 60)) + "/" + cut_utf8(mark, 60);
  }
}

std::string looks_of(const FoundDevice& found) {
  std::string out = found.rule->file + "\n" + found.device.devnode;
  for (const FoundChannel& channel : found.channels) {
    const SensorInfo& info = channel.plugged.info;
    for (const std::string& part : {channel.plugged.key, channel.attribute, info.identity, info.device}) {
      out += "\n" + part;
    }
  }
  return out;
}

void clean(std::map<std::string, std::string>& facts) {
  std::map<std::string, std::string> out;
  for (const auto& [name, value] : facts) out.insert_or_assign(cut_utf8(name, 128), cut_utf8(value, 1024));
  facts = std::move(out);
}

/// What it is called may hold any bytes. Its path and files stay as they are: they are opened, and shown by others.
void clean(Device& device) {
  clean(device.properties);
  clean(device.attributes);
  for (std::string* text : {&device.devtype, &device.sysname}) *text = cut_utf8(*text, 255);
}

}  // namespace

bool matches(const DeviceMatch& match, const Device& device) {
  return match.subsystem == device.subsystem && (match.devtype.empty() || match.devtype == device.devtype) &&
         (match.sysname.empty() || any_matches(match.sysname, device.sysname)) &&
         all_hold(match.properties, device.properties) && all_hold(match.attributes, device.attributes);
}

FoundDevice find_sensors(const Device& device, const std::shared_ptr<const SensorRule>& rule) {
  FoundDevice found{device, rule, {}};
  const std::string identity = identity_of(device, *rule);
  if (kind_of(rule->by).device_file && device.devnode.empty()) return found;
  for (const SensorChannel& how : rule->channels) {
    if (rule->by != ReadBy::attributes) {
      found.channels.push_back(make_channel(device, how, how.name, identity));
    } else if (how.attribute.empty()) {
      find_iio_channel(found, how, identity);
    } else {
      find_attributes(found, how, identity);
    }
  }
  distinguish_sensors(found);
  return found;
}

Recognition::Recognition(std::vector<SensorRule> rules)
    : subsystems_{"hwmon", "iio", "input", "tty", "video4linux", "w1"} {
  for (SensorRule& rule : rules) {
    for (const DeviceMatch& match : rule.matches) subsystems_.insert(match.subsystem);
    rules_.push_back(std::make_shared<const SensorRule>(std::move(rule)));
  }
}

std::set<std::string> Recognition::attributes_of(const std::string& subsystem) const {
  std::set<std::string> out{"name"};
  for (const auto& rule : rules_) {
    for (const DeviceMatch& match : rule->matches) {
      if (match.subsystem != subsystem) continue;
      for (const TextMatch& condition : match.attributes) out.insert(condition.name);
      if (rule->identity && !rule->identity->is_property) out.insert(rule->identity->name);
    }
  }
  return out;
}

FoundDevice Recognition::recognise(const Device& device) const {
  FoundDevice best;
  std::size_t best_conditions = 0;
  for (const auto& rule : rules_) {
    for (const DeviceMatch& match : rule->matches) {
      if (best.rule && match.conditions() <= best_conditions) continue;
      if (!matches(match, device)) continue;
      FoundDevice found = find_sensors(device, rule);
      if (found.channels.empty()) continue;
      best = std::move(found);
      best_conditions = match.conditions();
    }
  }
  return best;
}

Recognition::Change Recognition::on_present(Device device) {
  Change change;
  if (!subsystems_.contains(device.subsystem)) return change;
  clean(device);
  const std::string syspath = device.syspath;
  const auto before = known_.find(syspath);
  FoundDevice found = recognise(device);
  const bool full = known_.size() + unknown_.size() >= kMaxDevices;
  if (full && before == known_.end() && !unknown_.contains(syspath)) {
    ++refused_;
    return change;
  }
  if (!found.rule) return put_unknown(std::move(device));
  std::string looks = looks_of(found);
  if (before != known_.end() && before->second.looks == looks) return change;
  change = on_gone(syspath);
  change.unknown_changed = change.unknown_changed || !unknown_.empty();  // one below it may be listed no more
  known_.insert_or_assign(syspath, Known{std::move(device), std::move(looks)});
  change.plugged.push_back(std::move(found));
  return change;
}

Recognition::Change Recognition::put_unknown(Device device) {
  const std::string syspath = device.syspath;
  Change change = on_gone(syspath);
  if (!is_worth_listing(device)) return change;
  unknown_.insert_or_assign(syspath, std::move(device));
  change.unknown_changed = true;
  return change;
}

Recognition::Change Recognition::on_gone(const std::string& syspath) {
  Change change;
  if (known_.erase(syspath) > 0) {
    change.unplugged.push_back(syspath);
    change.unknown_changed = !unknown_.empty();
  }
  if (unknown_.erase(syspath) > 0) change.unknown_changed = true;
  return change;
}

Recognition::Change Recognition::on_moved(const std::string& old_syspath, Device device) {
  Change change = on_gone(old_syspath);
  Change there = on_present(std::move(device));
  change.unplugged.insert(change.unplugged.end(), there.unplugged.begin(), there.unplugged.end());
  change.plugged = std::move(there.plugged);
  change.unknown_changed = change.unknown_changed || there.unknown_changed;
  return change;
}

std::vector<UnknownDevice> Recognition::unknown() const {
  std::vector<UnknownDevice> out;
  for (const auto& [syspath, device] : unknown_) {
    const bool is_part = std::any_of(known_.begin(), known_.end(), [&path = syspath](const auto& known) {
      return path.starts_with(known.first + "/");
    });
    if (!is_part && out.size() < kMaxUnknown) out.push_back(describe_unknown(device));
  }
  return out;
}

std::vector<std::string> Recognition::present() const {
  std::vector<std::string> out;
  for (const auto& [syspath, ignored] : known_) out.push_back(syspath);
  for (const auto& [syspath, ignored] : unknown_) out.push_back(syspath);
  return out;
}

}  // namespace trb::sensor
