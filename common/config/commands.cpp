#include <algorithm>
#include <cctype>

#include "common/base/ids.hpp"
#include "common/config/readers.hpp"
#include "common/config/ros_words.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

using Words = std::map<std::string, std::string>;

constexpr std::size_t kMaxWords = 256;
constexpr std::size_t kMaxVendors = 64;
constexpr std::size_t kMaxTemplate = 16384;

bool is_index(std::string_view text) {
  return text.size() <= 2 && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_word_like(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
  });
}

/// The first {WORD} that is neither {data} nor {0}; other brackets belong to the vendor's language.
std::string foreign_placeholder(std::string_view words) {
  for (std::size_t open = words.find('{'); open != std::string_view::npos; open = words.find('{', open + 1)) {
    const std::size_t close = words.find('}', open);
    if (close == std::string_view::npos) break;
    const std::string_view inside = words.substr(open + 1, close - open - 1);
    if (is_word_like(inside) && inside != "data" && !is_index(inside)) return std::string(inside);
  }
  return {};
}

Words read_words(ObjectReader& vendor, std::string_view key) {
  Words words;
  const auto* members = vendor.object(key, Need::optional, kMaxWords);
  if (members == nullptr) return words;
  const Value json{*members};
  ObjectReader reader(json, vendor.path(key), vendor.faults());
  for (const auto& [subtype, ignored] : *members) {
    if (!is_valid_word(subtype)) {
      reader.faults().add(reader.path(subtype), in_quotes(subtype) + " is no subtype",
                          "use a letter, then letters, digits, _");
    }
    const std::string text = reader.text(subtype, Need::required, kMaxTemplate).value_or("unreadable");
    const std::string foreign = foreign_placeholder(text);
    if (!foreign.empty()) {
      reader.faults().add(reader.path(subtype), "{" + foreign + "} is no placeholder here",
                          "use {data} for all of the data, or {0}, {1} … for its parts");
    }
    words[subtype] = text;
  }
  return words;
}

std::optional<Monitor> read_monitor(ObjectReader& vendor) {
  const Value* json = vendor.value("monitor", Need::optional);
  if (json == nullptr) return std::nullopt;
  ObjectReader reader(*json, vendor.path("monitor"), vendor.faults());
  Monitor monitor;
  const std::vector<std::string> protocols = {"ur-primary", "ar-navdata", "rapid-service"};
  if (const auto index = reader.choice("protocol", Need::required, protocols)) monitor.protocol = protocols[*index];
  monitor.port = static_cast<std::uint16_t>(reader.integer("port", Need::required, 1, 65535).value_or(0));
  reader.refuse_unknown_keys();
  return monitor;
}

/// One of the names, or the name of index 0.
std::string read_choice(ObjectReader& vendor, std::string_view key, const std::vector<std::string>& names) {
  return names[vendor.choice(key, Need::optional, names).value_or(0)];
}

VendorCommands read_vendor(const Value& json, const std::string& name, const FileFaults& faults) {
  ObjectReader reader(json, name, faults);
  VendorCommands vendor;
  if (reader.value("port", Need::optional) != nullptr) {
    // A bad port counts as given: one mistake, one fault.
    vendor.port = static_cast<std::uint16_t>(reader.integer("port", Need::optional, 1, 65535).value_or(0));
  }
  const auto transports = transport_names();
  if (const auto index = reader.choice("transport", Need::optional, transports)) vendor.transport = transports[*index];
  vendor.language = read_choice(reader, "language", {"plain", "urscript"});
  vendor.wrap = read_choice(reader, "wrap", {"", "urscript-program"});
  vendor.monitor = read_monitor(reader);
  vendor.values = read_words(reader, "values");
  vendor.commands = read_words(reader, "commands");
  vendor.requests = read_words(reader, "requests");
  if (vendor.transport == "modbus") vendor.modbus = read_modbus_settings(reader);
  reader.refuse_unknown_keys();
  if (!vendor.wrap.empty() && vendor.language != "urscript") {
    faults.add(name + ".wrap", "wraps URScript, but \"language\" is '" + vendor.language + "'",
               "set \"language\" to \"urscript\", or remove \"wrap\"");
  }
  return vendor;
}

void check_monitor(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (vendor.monitor && vendor.monitor->protocol == "ar-navdata") {
    faults.add(name + ".monitor.protocol", "'ar-navdata' is not spoken beside tcp-text",
               R"(use "ur-primary", or the transport that the robot speaks)");
  }
  if (vendor.requests.empty() || vendor.monitor) return;
  faults.add(name + ".requests", "are answered from the monitor, but there is none",
             R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or remove the requests)");
}

/// A skill whose words are missing would wait for fields that this robot does not speak.
void check_skills(const NodeConfig& config, const FileFaults& faults) {
  std::vector<std::string> subtypes;
  for (const auto& [subtype, ignored] : config.commands.commands) subtypes.push_back(subtype);
  for (const Skill& skill : config.description.skills) {
    const bool watched = skill.end.kind == EndKind::state || skill.end.kind == EndKind::position;
    if (watched && !config.commands.monitor) {
      faults.add(config.framework + ".monitor", "is missing: the end of skill '" + skill.name + "' is seen by it",
                 R"(add "monitor": {"protocol": "ur-primary", "port": 30001}, or give the skill another end)");
    }
    if (config.description.has_field_channel || config.commands.commands.contains(skill.subtype)) continue;
    faults.add(config.framework + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
               did_you_mean(skill.subtype, subtypes, "add it, or let the skill's command use one of"));
  }
}

}  // namespace

AllCommands read_commands(const Value& json, const FileFaults& faults) {
  AllCommands all;
  const ObjectReader reader(json, "", faults);
  if (!json.is_object() || !check_count(faults, "", json.object().size(), kMaxVendors)) return all;
  for (const auto& [name, vendor] : json.object()) all[name] = read_vendor(vendor, name, faults);
  return all;
}

void check_words(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (!vendor.commands.contains("stop")) {
    faults.add(name + ".commands.stop", "is missing: every vendor must say how it is stopped",
               "add \"stop\" with the vendor's words for stopping all motion, for example \"stop program\"");
  }
  for (const auto& [subtype, words] : vendor.commands) {
    if (!words.empty() || subtype == "release") continue;
    std::string key = name;
    key.append(".commands.").append(subtype);
    faults.add(key, "has no words, the robot would be sent nothing",
               "write the vendor's words, or remove it; only \"release\" may be empty");
  }
}

void check_tcp_text(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  require_port(config, faults, "30002 for a Universal Robot");
  check_words(vendor, name, faults);
  check_monitor(vendor, name, faults);
  check_skills(config, faults);
}

void check_ros(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  check_words(vendor, config.framework, faults);
  for (const auto& [subtype, words] : vendor.commands) {
    const auto read = read_ros_publications(words);
    if (!read) faults.add(config.framework + ".commands." + subtype, read.error().what, read.error().cure);
  }
  for (const auto& [subtype, words] : vendor.requests) {
    const auto read = read_ros_question(words);
    if (!read) faults.add(config.framework + ".requests." + subtype, read.error().what, read.error().cure);
  }
  for (const Skill& skill : config.description.skills) {
    if (!vendor.commands.contains(skill.subtype) && !config.description.has_field_channel) {
      faults.add(config.framework + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
                 "add it with its topic");
    }
    if (skill.end.kind == EndKind::acknowledgement && vendor.commands.contains(skill.subtype)) {
      faults.add(config.framework + ".commands." + skill.subtype,
                 "ends skill '" + skill.name + "' with an acknowledgement, which ROS never gives",
                 "give the skill an end of kind \"position\", \"state\" or \"time\"");
    }
    const bool position = skill.end.kind == EndKind::position;
    const std::string watched = skill.end.state.empty() ? "position" : skill.end.state;
    if ((position || skill.end.kind == EndKind::state) && !vendor.requests.contains(watched)) {
      faults.add(
          config.framework + ".requests." + watched, "is missing: the end of skill '" + skill.name + "' is seen by it",
          R"(add it with a topic and its numbers, for example "/odom pose.pose.position.x pose.pose.position.y")");
    }
  }
}

}  // namespace trb
