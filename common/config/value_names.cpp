// Checks that the robot reports the values that a description watches.
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

}  // namespace trb
