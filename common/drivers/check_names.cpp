#include "common/drivers/check_names.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {

void check_requests(const NodeConfig& config, const std::vector<std::string>& known, const FileFaults& faults) {
  const std::string path = config.framework + ".requests.";
  for (const auto& [subtype, value] : config.commands.requests) {
    if (std::ranges::find(known, value) != known.end()) continue;
    faults.add(path + subtype, in_quotes(value) + " is not one of the values",
               did_you_mean(value, known, "add it to \"values\", or use one of"));
  }
}

void check_command(const NodeConfig& config, const Skill& skill, const FileFaults& faults) {
  const auto& commands = config.commands.commands;
  if (config.description.has_field_channel || commands.contains(skill.subtype)) return;
  faults.add(config.framework + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
             did_you_mean(skill.subtype, names_in(commands), "add it, or let the skill's command use one of"));
}

}  // namespace trb::drivers
