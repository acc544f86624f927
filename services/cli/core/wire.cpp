#include "services/cli/core/wire.hpp"

namespace trb::cli {

std::string note_of_wire(const std::string& fleet_address, const std::string& robot_address,
                         const std::string& robot_host) {
  if (robot_host.empty() || robot_address.empty() || robot_address != fleet_address) return {};
  if (robot_address.starts_with("127.")) return {};
  return "robot.interface: the robot " + robot_host + " hangs on the fleet's own interface (" + fleet_address +
         "): whoever is in that network can speak to it past its node, unencrypted; give it a wire of its own, and "
         "name that interface";
}

}  // namespace trb::cli
