#include "services/cli/core/new_node.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb::cli {
namespace {

// Where the address stands: the makers' manuals (PolyScope 3 and 5, FlexPendant of RobotWare 6, smartHMI of KSS 8,
// AR.Drone SDK 2, Pioneer 3 operations manual, MiR REST API 2, Dobot's TCP/IP protocol 4).
constexpr RobotKind kKinds[] = {
    {"ur", "Universal Robots", "ur", "ur3.json", "teach pendant: Setup Robot (or Settings > System), Network",
     "remote control, where PolyScope has that switch; port 30002 is open as delivered"},
    {"abb", "ABB", "abb", "abb.json", "FlexPendant: System Info, Controller, Network Connections (the WAN port)",
     "the RAPID programs in config/robots/abb, as the handbook's page robots/abb.md says"},
    {"kuka", "KUKA", "kuka", "kuka.json", "smartHMI: Start-up, Network configuration (the KLI's address)",
     "KUKAVARPROXY on port 7000, and config/robots/kuka, as the handbook's page robots/kuka.md says"},
    {"pioneer", "MobileRobots", "pioneer", "pioneer.json",
     "the serial-to-network adapter's own page: its address; port 8101 leads to the robot's serial port",
     "the adapter set to 9600 baud, 8N1, raw TCP"},
    {"drone", "Parrot", "ardrone", "drone.json", "192.168.1.1 in the drone's own Wi-Fi, as delivered",
     "this computer in the drone's Wi-Fi"},
    {"mir", "Mobile Industrial Robots", "mir", "mir100.json", "the robot's own page: Setup, Wi-Fi or Network",
     "a user of its REST interface, in keys/robot.auth (mode 0600): basic USER:SHA-256 of the password"},
    {"dobot", "Dobot", "dobot", "dobot-cr5.json", "DobotStudio Pro: the controller's address; 192.168.5.1 as delivered",
     "the remote control mode TCP/IP, set in DobotStudio Pro; port 29999"},
    {"plc", "any with Modbus/TCP", "plc", "conveyor.json",
     "the PLC's engineering tool: the Modbus/TCP server's address",
     "the registers as commands.json has them, or the other way round"},
    {"ros", "any with ROS 1", "ros", "turtlebot.json", "on the robot: echo $ROS_MASTER_URI (the host in it)",
     "ROS_IP or ROS_HOSTNAME of the robot set to an address that this computer reaches", true},
    {"fields", "your own program", "lines", "field-example.json", "the computer from which your program connects",
     "a client of proto/FIELD_CHANNEL.md (config/robots/c, config/robots/python) that dials this node's port 40000"},
};

std::string comment(std::string_view text, const std::string& indent) {
  return indent + "\"_comment\": \"" + std::string(text) + "\",\n";
}
std::string member(std::string_view key, std::string_view value, const std::string& indent, bool last = false) {
  return indent + "\"" + std::string(key) + "\": \"" + std::string(value) + (last ? "\"\n" : "\",\n");
}

/// In a text of JSON, so the example's quotes have backslashes.
std::string seeds_comment(const std::string& example) {
  return "Nodes that beacons do not reach (" + example +
         R"(, for example): [{\"address\": \"10.0.0.1:45000\", \"key\": \"LINK KEY by trb fleet show there\"}].)";
}

}  // namespace

std::span<const RobotKind> robot_kinds() {
  return kKinds;
}

Result<RobotKind> robot_kind(const std::string& like) {
  const auto* const at = std::ranges::find(kKinds, like, &RobotKind::like);
  if (at != std::end(kKinds)) return *at;
  std::vector<std::string> names;
  for (const RobotKind& kind : kKinds) names.emplace_back(kind.like);
  return fail(Errc::bad_value, "--like: no robot like " + in_quotes(like), did_you_mean(like, names, "use one of"));
}

std::string node_json_of(const NewNode& node) {
  const std::string in = "  ";
  const std::string deep = "    ";
  std::string out = "{\n";
  out += comment("The robot's name in the fleet. Its certificate has it: another name needs other keys.", in);
  out += member("id", node.id, in);
  out += comment("Its language: commands.json has the words under this name, profile.json the mode.", in);
  out += member("framework", node.kind.framework, in);
  out += comment("What it can do and where: adapt that file to your robot; trb robot check reads it.", in);
  out += member("description", "robots/" + std::string(node.kind.description), in);
  out += in + "\"robot\": {\n";
  out += comment("Its address: " + std::string(node.kind.address_at) + ".", deep);
  const bool has_faults = !node.told_faults_at.empty();
  out += member("host", node.robot_address, deep, node.robot_side.empty() && !has_faults);
  if (!node.robot_side.empty()) {
    out += comment("This computer's address or interface towards the robot: ip address lists them.", deep);
    out += member("interface", node.robot_side, deep, !has_faults);
  }
  if (has_faults) {
    out += comment("Where this virtual robot is told to fail: trb robot fault.", deep);
    out += member("fault_injection", node.told_faults_at, deep, true);
  }
  out += in + "},\n";
  out += comment(seeds_comment("a cloud node behind a VPN"), in);
  out += in + "\"seeds\": [],\n";
  out += comment("Add sensor-bus if sensors are plugged into this computer.", in);
  out += in + "\"services\": [\"router\", \"mode-adapter\", " + (node.kind.has_ros ? "\"ros-bridge\", " : "") +
         "\"scheduler\"]\n}\n";
  return out;
}

std::string node_json_of(const NewCloud& cloud) {
  const std::string in = "  ";
  std::string out = "{\n";
  out += comment("Its name in the fleet. Its certificate has it: another name needs other keys.", in);
  out += member("id", cloud.id, in) + member("role", "cloud", in);
  out += comment(seeds_comment("another cloud node"), in);
  out += in + "\"seeds\": [],\n";
  out += comment("cloud-gateway is the page; cloud.json says where it listens.", in);
  return out + in + "\"services\": [\"router\", \"scheduler\", \"resilience\"" +
         (cloud.page.empty() ? "" : ", \"cloud-gateway\"") + "]\n}\n";
}

std::string cloud_json_of(const NewCloud& cloud) {
  const std::string in = "  ";
  std::string out = "{\n";
  out +=
      comment("Where the page listens: 127.0.0.1:8443 is for this computer alone, 0.0.0.0:8443 for every network.", in);
  out += member("listen", cloud.page, in);
  out += comment(
      "What people type into the browser: names and addresses, as hall.example, 192.168.1.10. By others nobody can",
      in);
  out += comment("sign in; localhost, and the one address of listen, are always good.", in);
  return out + in + "\"names\": []\n}\n";
}

std::string network_json_of(const std::string& fleet_side) {
  const std::string in = "  ";
  std::string out = "{\n";
  out += comment("The ports of the whole fleet: the same in every node's file.", in);
  out += in + "\"UDP_PORT\": 50000,\n" + in + "\"TCP_PORT_EXT\": 45000,\n" + in + "\"LANE_PORT\": 45001,\n";
  out += comment("On which a robot's own program connects, if it is reached field by field.", in);
  out += in + "\"TCP_PORT\": 40000,\n";
  out += comment("This computer on the fleet's network, by interface or address: ip address lists them.", in);
  out += member("HOST_INT", fleet_side, in);
  out += comment("Its interface of a VPN; it need not exist.", in);
  return out + member("VPN_INT", "tun0", in, true) + "}\n";
}

}  // namespace trb::cli
