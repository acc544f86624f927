#include "common/drivers/tcp-text/monitored_names.hpp"

#include <algorithm>

#include "common/drivers/check_requests.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

/// A value may be watched by its own name, or by the subtype of its request.
void check_end(const NodeConfig& config, const Skill& skill, const FileFaults& faults) {
  const std::string& watched = skill.end.state;
  const VendorCommands& vendor = config.commands;
  const bool by_value = skill.end.kind == EndKind::state || skill.end.kind == EndKind::position;
  if (!by_value || watched.empty() || !vendor.commands.contains(skill.subtype)) return;
  std::vector<std::string> known = ur_monitored_values();
  for (const std::string& request : names_in(vendor.requests)) known.push_back(request);
  if (std::ranges::find(known, watched) != known.end()) return;
  faults.add(config.framework + ".monitor",
             "does not tell " + in_quotes(watched) + ", by which the end of skill '" + skill.name + "' is seen",
             did_you_mean(watched, known, "let the skill's end in the description name one of"));
}

}  // namespace

const std::vector<std::string>& ur_monitored_values() {
  static const std::vector<std::string> kNames{"joints", "robot_mode", "safety", "program_running",
                                               "power",  "tool",       "speed",  "reach"};
  return kNames;
}

void check_monitored_names(const NodeConfig& config, const FileFaults& faults) {
  if (!config.commands.values.empty()) {
    faults.add(config.framework + ".values", "is no part of tcp-text, whose values the monitor tells",
               "remove it; \"requests\" may name one of " + join(ur_monitored_values()));
  }
  if (!config.commands.monitor || config.commands.monitor->protocol != "ur-primary") return;
  check_requests(config, ur_monitored_values(), faults, "use one of");
  for (const Skill& skill : config.description.skills) check_end(config, skill, faults);
}

}  // namespace trb::drivers
