// Checks that commands.json and the description have all that a KUKA over C3 needs.
#include <algorithm>

#include "common/config/described_names.hpp"
#include "common/config/transports.hpp"
#include "common/drivers/c3/commands.hpp"
#include "common/drivers/check_requests.hpp"
#include "common/drivers/place_items.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kExample = "add it, for example \"$POS_ACT X Y Z\"";

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
  check_requests(config, names_in(vendor.values), faults);
  if (fields && config.description.field_channel.encoding == Encoding::numeric) {
    faults.add(name + ".transport", "'c3' writes text into variables, and the description says \"numeric\"",
               "set \"encoding\" to \"text\" in the description");
  }
  const bool tells_end = fields || vendor.values.contains("trb_done");
  for (const Skill& skill : config.description.skills) {
    check_skill_command(config, skill, faults);
    check_place_items(config, skill, Items::exact, faults);
    check_end(config, skill, tells_end, faults);
  }
}

}  // namespace trb::drivers
