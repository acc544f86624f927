// Checks that commands.json and the description have all that a KUKA over C3 needs.
#include <algorithm>

#include "common/config/transports.hpp"
#include "common/drivers/c3/commands.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kExample = "add it, for example \"$POS_ACT X Y Z\"";

std::vector<std::string> names_of(const std::map<std::string, std::string>& words) {
  std::vector<std::string> names;
  for (const auto& [name, ignored] : words) names.push_back(name);
  return names;
}

void check_requests(const VendorCommands& vendor, const std::string& name, const FileFaults& faults) {
  for (const auto& [subtype, value] : vendor.requests) {
    if (vendor.values.contains(value)) continue;
    faults.add(name + ".requests." + subtype, in_quotes(value) + " is none of the values",
               did_you_mean(value, names_of(vendor.values), "add it to \"values\", or use one of"));
  }
}

void check_end(const NodeConfig& config, const Skill& skill, bool tells_end, const FileFaults& faults) {
  const auto& values = config.commands.values;
  const std::string path = config.framework + ".values.";
  if (skill.end.kind == EndKind::acknowledgement && !tells_end) {
    faults.add(path + "trb_done", "is missing: skill '" + skill.name + "' ends with an acknowledgement",
               "name the variable that the robot's program sets TRUE at the end, or give the skill another end");
  }
  const bool position = skill.end.kind == EndKind::position;
  if (position && !values.contains("position") && !values.contains("joints")) {
    faults.add(path + "position", "is missing: the end of skill '" + skill.name + "' is seen by it", kExample);
  }
  if (skill.end.kind == EndKind::state && !values.contains(skill.end.state)) {
    faults.add(path + skill.end.state, "is missing: the end of skill '" + skill.name + "' is seen by it", kExample);
  }
}

}  // namespace

void check_c3(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  const std::string& name = config.framework;
  const bool fields = config.description.has_field_channel;
  require_port(config, faults, "7000");
  check_words(vendor, name, faults);
  read_c3_commands(vendor, config.description, VendorFaults(name, faults));
  check_requests(vendor, name, faults);
  if (fields && config.description.field_channel.encoding == Encoding::numeric) {
    faults.add(name + ".transport", "'c3' writes text into variables, and the description says \"numeric\"",
               "set \"encoding\" to \"text\" in the description");
  }
  const bool tells_end = fields || vendor.values.contains("trb_done");
  for (const Skill& skill : config.description.skills) {
    if (!fields && !vendor.commands.contains(skill.subtype)) {
      faults.add(
          name + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
          did_you_mean(skill.subtype, names_of(vendor.commands), "add it, or let the skill's command use one of"));
    }
    check_end(config, skill, tells_end, faults);
  }
}

}  // namespace trb::drivers
