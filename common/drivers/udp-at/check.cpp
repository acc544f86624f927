// What the transport udp-at requires of commands.json.
#include <algorithm>

#include "common/config/transports.hpp"
#include "common/drivers/udp-at/commands.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kMonitor = R"(add "monitor": {"protocol": "ar-navdata", "port": 5554})";

/// The names that the node may ask for: commands.json's own and navdata's.
std::vector<std::string> value_names(const VendorCommands& vendor) {
  std::vector<std::string> names = at_value_names();
  for (const std::string& name : names_in(vendor.values)) names.push_back(name);
  return names;
}

void check_name(const std::string& name, const std::vector<std::string>& names, const std::string& key,
                const FileFaults& faults) {
  if (std::ranges::find(names, name) != names.end()) return;
  faults.add(key, in_quotes(name) + " is nothing that navdata tells", did_you_mean(name, names, "use one of"));
}

void check_end(const Skill& skill, const AtCommands& commands, const VendorCommands& vendor, const std::string& name,
               const FileFaults& faults) {
  if (!vendor.commands.contains(skill.subtype)) return;
  const std::string key = name + ".commands." + skill.subtype;
  if (skill.end.kind == EndKind::state) check_name(skill.end.state, value_names(vendor), key, faults);
  if (skill.end.kind == EndKind::position) {
    faults.add(key, "ends skill '" + skill.name + "' at a position, and navdata tells none",
               R"(give the skill an end of kind "acknowledgement", "state" or "time")");
  }
  const auto lines = commands.find(skill.subtype);
  if (skill.end.kind != EndKind::acknowledgement || lines == commands.end()) return;
  if (std::ranges::any_of(lines->second, at_tells_end)) return;
  faults.add(key, "has no end that the drone tells, and skill '" + skill.name + "' waits for one",
             R"(write "hover for {data}", or give the skill an end of kind "state" or "time")");
}

}  // namespace

void check_udp_at(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  require_port(config, faults, "5556 for an AR.Drone 2");
  if (!vendor.monitor || vendor.monitor->protocol != "ar-navdata") {
    faults.add(name + ".monitor", "is missing: a drone is commanded only while its navdata is received", kMonitor);
  }
  check_words(vendor, name, faults);
  const AtCommands commands = read_at_commands(vendor, config.description, VendorFaults(name, faults));
  const std::string values = name + ".values.";
  for (const auto& [value, word] : vendor.values) check_name(word, at_value_names(), values + value, faults);
  const std::string requests = name + ".requests.";
  const std::vector<std::string> known = value_names(vendor);
  for (const auto& [subtype, value] : vendor.requests) check_name(value, known, requests + subtype, faults);
  for (const Skill& skill : config.description.skills) {
    if (!vendor.commands.contains(skill.subtype) && !config.description.has_field_channel) {
      faults.add(name + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
                 R"(add it, for example "REF take_off")");
    }
    check_end(skill, commands, vendor, name, faults);
  }
}

}  // namespace trb::drivers
