// The small fleet of `trb demo`: who is in it, its files, its programs. No robot is needed, and no network.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "services/cli/core/new_node.hpp"

namespace trb::cli {

struct DemoFleet {
  std::string network;     ///< "127.0.42": the nodes have .1 and up, the robots .101 and up
  unsigned page_port = 0;  ///< of the cloud's page on 127.0.0.1; 0: none
  double speed = 1;        ///< how much faster than real ones the robots move
};

constexpr std::string_view kDemoCloud = "cloud";

/// A virtual robot, and the kind of robot that its node is made for.
struct DemoRobot {
  std::string_view id;
  std::string_view like;
  std::string_view program;
};
std::span<const DemoRobot> demo_robots();

/// Errors: bad_value: not the first three numbers of a loopback address, a port out of 1024 to 65535, a speed out of
/// 0.1 to 100.
Result<DemoFleet> demo_fleet(const std::string& network, double page_port, double speed = 1);

/// An address and a TCP port.
struct DemoPort {
  std::string address;
  std::uint16_t port = 0;
};
/// Where its routers and virtual robots listen: what another demonstration in the same network holds.
std::vector<DemoPort> demo_ports(const DemoFleet& fleet);
/// Another one: "127.0.43" for "127.0.42".
std::string next_network(const DemoFleet& fleet);

/// Kept in its folder as demo.json, so that it can be started again.
std::string demo_json(const DemoFleet& fleet);
/// Errors: malformed, bad_value.
Result<DemoFleet> demo_fleet_of(std::string_view demo_json);

NewCloud cloud_of(const DemoFleet& fleet);
NewNode node_of(const DemoFleet& fleet, std::size_t robot);  ///< its number in demo_robots()
std::vector<std::string> robot_arguments(const DemoFleet& fleet, std::size_t robot);

/// The rover drives to table1, then the arm picks: a scenario of two tasks.
std::string_view demo_scenario();

}  // namespace trb::cli
