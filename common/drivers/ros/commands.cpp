#include "common/drivers/ros/commands.hpp"

namespace trb::drivers {

RosCommands read_ros_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  RosCommands out;
  for (const auto& [subtype, words] : vendor.commands) {
    auto read = read_ros_publications(words);
    if (!read) {
      faults.add("commands." + subtype, read.error());
    } else {
      out.commands.emplace(subtype, std::move(*read));
    }
  }
  for (const auto& [subtype, words] : vendor.requests) {
    auto read = read_ros_question(words);
    if (!read) {
      faults.add("requests." + subtype, read.error());
    } else {
      out.requests.emplace(subtype, std::move(*read));
    }
  }
  return out;
}

}  // namespace trb::drivers
