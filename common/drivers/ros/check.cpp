// What the transport ros requires of commands.json.
#include "common/config/transports.hpp"
#include "common/drivers/ros/commands.hpp"

namespace trb::drivers {

void check_ros(const NodeConfig& config, const FileFaults& faults);

void check_ros(const NodeConfig& config, const FileFaults& faults) {
  const VendorCommands& vendor = config.commands;
  check_words(vendor, config.framework, faults);
  read_ros_commands(vendor, config.description, VendorFaults(config.framework, faults));
  for (const Skill& skill : config.description.skills) {
    if (!vendor.commands.contains(skill.subtype) && !config.description.has_field_channel) {
      faults.add(config.framework + ".commands." + skill.subtype, "is missing: skill '" + skill.name + "' sends it",
                 "add it with its topic");
    }
    if (skill.end.kind == EndKind::acknowledgement && vendor.commands.contains(skill.subtype)) {
      faults.add(config.framework + ".commands." + skill.subtype,
                 "ends skill '" + skill.name + "' with an acknowledgement, which ROS never gives",
                 "give the skill an end of kind \"position\", \"state\" or \"time\"");
    }
    const bool position = skill.end.kind == EndKind::position;
    const std::string watched = skill.end.state.empty() ? "position" : skill.end.state;
    if ((position || skill.end.kind == EndKind::state) && !vendor.requests.contains(watched)) {
      faults.add(
          config.framework + ".requests." + watched, "is missing: the end of skill '" + skill.name + "' is seen by it",
          R"(add it with a topic and its numbers, for example "/odom pose.pose.position.x pose.pose.position.y")");
    }
  }
}

}  // namespace trb::drivers
