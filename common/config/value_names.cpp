// That the values which a description watches are told by the robot.
#include <algorithm>

#include "common/config/readers.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

/// Told by every controller that the monitor "ur-primary" reads.
const std::vector<std::string> kUrValues = {"joints", "robot_mode", "safety", "program_running"};

std::vector<std::string> values_of(const VendorCommands& vendor) {
  std::vector<std::string> names;
  if (vendor.monitor && vendor.monitor->protocol == "ur-primary") names = kUrValues;
  for (const auto& [name, ignored] : vendor.values) names.push_back(name);
  for (const auto& [name, ignored] : vendor.requests) names.push_back(name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace

void check_value_names(const NodeConfig& config, const std::string& file, ConfigFaults& faults) {
  // In fields a robot names what it tells as it goes.
  // Without the vendor's words that alone is the fault.
  if (config.commands.commands.empty() || config.commands.transport == "lines") return;
  if (config.description.has_field_channel) return;
  const std::vector<std::string> known = values_of(config.commands);
  const FileFaults sink(file, faults);
  const auto check = [&](const std::string& name, const std::string& key) {
    if (name.empty() || std::find(known.begin(), known.end(), name) != known.end()) return;
    sink.add(key, in_quotes(name) + " is no value that commands.json names under '" + config.framework + "'",
             did_you_mean(name, known, known.empty() ? R"(add it to "values" there)" : "add it there, or use one of"));
  };
  for (const FaultRule& rule : config.description.faults) check(rule.value, "faults." + rule.name + ".value");
  for (const std::string& name : config.description.sensors) check(name, "sensors");
}

}  // namespace trb
