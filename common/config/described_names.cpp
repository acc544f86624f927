#include "common/config/described_names.hpp"

#include <algorithm>
#include <vector>

#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

std::vector<std::string> values_of(const VendorCommands& vendor, const Transport& transport) {
  std::vector<std::string> names;
  if (vendor.monitor) names = transport.monitored_values;
  for (const auto& [name, ignored] : vendor.values) names.push_back(name);
  for (const auto& [name, ignored] : vendor.requests) names.push_back(name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void check_values(const NodeConfig& config, const Transport& transport, const FileFaults& faults) {
  const std::vector<std::string> names = values_of(config.commands, transport);
  const auto check = [&](const std::string& name, const std::string& key) {
    if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return;
    faults.add(
        key, in_quotes(name) + " is no value that commands.json names under '" + config.framework + "'",
        did_you_mean(name, names, names.empty() ? R"(add it to "values" there)" : "add it there, or use one of"));
  };
  for (const FaultRule& rule : config.description.faults) check(rule.value, "faults." + rule.name + ".value");
  for (const std::string& name : config.description.sensors) check(name, "sensors");
}

void check_drives(const NodeConfig& config, const FileFaults& faults) {
  const auto& commands = config.commands.commands;
  const auto check = [&](const Skill& skill, const std::string& key) {
    if (skill.subtype.empty() || commands.contains(skill.subtype)) return;
    faults.add(key, in_quotes(skill.subtype) + " is no command that commands.json has under '" + config.framework + "'",
               did_you_mean(skill.subtype, names_in(commands), "add it there, or use one of"));
  };
  for (std::size_t i = 0; i < config.description.drives.size(); ++i) {
    const Drive& drive = config.description.drives[i];
    const std::string at = "drives[" + std::to_string(i) + "]";
    check(drive.command, at + ".command.subtype");
    if (drive.stand) check(*drive.stand, at + ".stand.subtype");
  }
}

}  // namespace

void check_described_names(const NodeConfig& config, const Transports& known, const std::string& file,
                           ConfigFaults& faults) {
  const Transport* transport = known.find(config.commands.transport);
  // Without the vendor's commands, only their absence is reported.
  if (transport == nullptr || !transport->names_values || config.commands.commands.empty()) return;
  if (config.description.has_field_channel) return;
  const FileFaults sink(file, faults);
  check_values(config, *transport, sink);
  check_drives(config, sink);
}

bool check_skill_command(const NodeConfig& config, const Skill& skill, const FileFaults& faults,
                         std::string_view example) {
  const auto& commands = config.commands.commands;
  if (commands.contains(skill.subtype)) return true;
  if (config.description.has_field_channel) return false;
  const std::string hint =
      example.empty() ? did_you_mean(skill.subtype, names_in(commands), "add it, or let the skill's command use one of")
                      : "add it with " + std::string(example);
  faults.add(config.framework + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it", hint);
  return false;
}

}  // namespace trb
