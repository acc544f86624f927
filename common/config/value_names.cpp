// Checks that commands.json has what a description names: the values that it watches, the words of its drives.
#include <algorithm>

#include "common/config/readers.hpp"
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

}  // namespace

void check_value_names(const NodeConfig& config, const Transports& known, const std::string& file,
                       ConfigFaults& faults) {
  const Transport* transport = known.find(config.commands.transport);
  // Without the vendor's commands, only their absence is reported.
  if (transport == nullptr || !transport->names_values || config.commands.commands.empty()) return;
  if (config.description.has_field_channel) return;
  const std::vector<std::string> names = values_of(config.commands, *transport);
  const FileFaults sink(file, faults);
  const auto check = [&](const std::string& name, const std::string& key) {
    if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return;
    sink.add(key, in_quotes(name) + " is no value that commands.json names under '" + config.framework + "'",
             did_you_mean(name, names, names.empty() ? R"(add it to "values" there)" : "add it there, or use one of"));
  };
  for (const FaultRule& rule : config.description.faults) check(rule.value, "faults." + rule.name + ".value");
  for (const std::string& name : config.description.sensors) check(name, "sensors");
}

void check_drive_words(const NodeConfig& config, const Transports& known, const std::string& file,
                       ConfigFaults& faults) {
  const Transport* transport = known.find(config.commands.transport);
  const auto& words = config.commands.commands;
  if (transport == nullptr || !transport->names_values || words.empty() || config.description.has_field_channel) return;
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const auto& [subtype, ignored] : words) names.push_back(subtype);
  const FileFaults sink(file, faults);
  const auto check = [&](const Skill& skill, const std::string& key) {
    if (skill.subtype.empty() || words.contains(skill.subtype)) return;
    sink.add(key, in_quotes(skill.subtype) + " is no command that commands.json has under '" + config.framework + "'",
             did_you_mean(skill.subtype, names, "add it there, or use one of"));
  };
  for (std::size_t i = 0; i < config.description.drives.size(); ++i) {
    const Drive& drive = config.description.drives[i];
    const std::string at = "drives[" + std::to_string(i) + "]";
    check(drive.command, at + ".command.subtype");
    if (drive.stand) check(*drive.stand, at + ".stand.subtype");
  }
}

}  // namespace trb
