// What commands.json must say for a drone that takes AT commands over UDP.
#include <algorithm>

#include "common/config/transports.hpp"
#include "common/drivers/udp-at/syntax.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kMonitor = R"(add "monitor": {"protocol": "ar-navdata", "port": 5554})";

/// The names that the node may ask for: commands.json's own and navdata's.
std::vector<std::string> value_names(const VendorCommands& vendor) {
  std::vector<std::string> names = at_value_names();
  for (const auto& [name, ignored] : vendor.values) names.push_back(name);
  return names;
}

void check_name(const std::string& name, const std::vector<std::string>& names, const std::string& key,
                const FileFaults& faults) {
  if (std::ranges::find(names, name) != names.end()) return;
  faults.add(key, in_quotes(name) + " is nothing that navdata tells", did_you_mean(name, names, "use one of"));
}

void check_stop(const std::string& words, const std::string& key, const FileFaults& faults) {
  const auto lines = read_at_lines(words);
  if (!lines || lines->empty()) return;
  const AtAction action = lines->front().action;
  const bool fits = action == AtAction::land || (action == AtAction::hover && lines->front().duration.empty());
  if (lines->size() == 1 && fits) return;
  faults.add(key, "stops no drone: it must stand in the air or land",
             R"(write "hover" or "REF land"; cutting the motors is a command of its own, "REF emergency")");
}

void check_lines(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  for (const auto& [subtype, words] : vendor.commands) {
    const std::string key = name + ".commands." + subtype;
    const auto lines = read_at_lines(words);
    if (!lines) faults.add(key, lines.error().what, lines.error().hint);
    if (subtype == "stop") check_stop(words, key, faults);
    if (subtype == "release" && !words.empty()) {
      faults.add(key, "lifting a stop moves no drone", "leave its words empty");
    }
  }
}

void check_end(const Skill& skill, const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  const auto words = vendor.commands.find(skill.subtype);
  if (words == vendor.commands.end()) return;
  const std::string key = name + ".commands." + skill.subtype;
  if (skill.end.kind == EndKind::state) check_name(skill.end.state, value_names(vendor), key, faults);
  if (skill.end.kind == EndKind::position) {
    faults.add(key, "ends skill '" + skill.name + "' at a position, and navdata tells none",
               R"(give the skill an end of kind "acknowledgement", "state" or "time")");
  }
  const auto lines = read_at_lines(words->second);
  if (skill.end.kind != EndKind::acknowledgement || !lines || std::ranges::any_of(*lines, at_tells_end)) return;
  faults.add(key, "has no end that the drone tells, and skill '" + skill.name + "' waits for one",
             R"(write "hover for {data}", or give the skill an end of kind "state" or "time")");
}

}  // namespace

void check_udp_at(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  require_port(config, faults, "5556 for an AR.Drone 2");
  if (!vendor.monitor || vendor.monitor->protocol != "ar-navdata") {
    faults.add(name + ".monitor", "is missing: a drone is commanded only while its navdata is heard", kMonitor);
  }
  check_words(vendor, name, faults);
  check_lines(vendor, name, faults);
  for (const auto& [value, word] : vendor.values) {
    check_name(word, at_value_names(), name + ".values." + value, faults);
  }
  for (const auto& [subtype, value] : vendor.requests) {
    check_name(value, value_names(vendor), name + ".requests." + subtype, faults);
  }
  for (const Skill& skill : config.description.skills) {
    if (!vendor.commands.contains(skill.subtype) && !config.description.has_field_channel) {
      faults.add(name + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
                 R"(add it, for example "REF take_off")");
    }
    check_end(skill, vendor, name, faults);
  }
}

}  // namespace trb::drivers
