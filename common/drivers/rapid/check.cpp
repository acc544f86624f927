// Checks that commands.json and the description have all that an ABB with a RAPID server needs.
#include <algorithm>

#include "common/config/described_names.hpp"
#include "common/config/transports.hpp"
#include "common/drivers/check_requests.hpp"
#include "common/drivers/place_items.hpp"
#include "common/drivers/rapid/commands.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kService =
    R"(add "monitor": {"protocol": "rapid-service", "port": 5001}, and the service task on the robot)";

void check_service(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  if (!vendor.monitor) {
    faults.add(name + ".monitor",
               "is missing: a move blocks the robot's program, and without its service task a stop would wait for the "
               "move's end",
               kService);
  } else if (vendor.monitor->protocol != "rapid-service") {
    faults.add(name + ".monitor.protocol", in_quotes(vendor.monitor->protocol) + " is not of the transport 'rapid'",
               "use \"rapid-service\"");
  }
}

/// What a request may ask for: the robot's state, and commands.json's own values.
std::vector<std::string> value_names(const VendorCommands& vendor) {
  std::vector<std::string> names = rapid_state_values();
  for (const std::string& name : names_in(vendor.values)) names.push_back(name);
  return names;
}

void check_skill(const NodeConfig& config, const Skill& skill, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  check_skill_command(config, skill, faults);
  check_place_items(config, skill, Items::exact, faults);
  const auto told = [&](const std::string& value) {
    return vendor.values.contains(value) ||
           std::ranges::find(rapid_state_values(), value) != rapid_state_values().end();
  };
  const bool position = skill.end.kind == EndKind::position;
  const bool seen =
      position ? told("position") || told("joints") : skill.end.kind != EndKind::state || told(skill.end.state);
  if (seen) return;
  faults.add(config.framework + ".values." + (position ? "position" : skill.end.state),
             "is missing: the end of skill '" + skill.name + "' is seen by it",
             "add it, for example \"service 4 0 1 2 3 4 5\"");
}

}  // namespace

void check_rapid(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  require_port(config, faults, "5000");
  check_words(vendor, config.framework, faults);
  check_service(vendor, config.framework, faults);
  read_rapid_commands(vendor, config.description, VendorFaults(config.framework, faults));
  check_requests(config, value_names(vendor), faults);
  for (const Skill& skill : config.description.skills) check_skill(config, skill, faults);
}

}  // namespace trb::drivers
