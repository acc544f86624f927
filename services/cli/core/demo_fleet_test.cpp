#include "services/cli/core/demo_fleet.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace trb;
using namespace trb::cli;

TEST_CASE("demo: nodes and robots have addresses of their own, in one network of this computer") {
  const DemoFleet fleet = *demo_fleet("127.0.42", 0);
  std::set<std::string> addresses{cloud_of(fleet).fleet_side};
  for (std::size_t i = 0; i < demo_robots().size(); ++i) {
    const NewNode node = node_of(fleet, i);
    addresses.insert(node.fleet_side);
    addresses.insert(node.robot_address);
    CHECK(node.id == demo_robots()[i].id);
    CHECK(robot_arguments(fleet, i)[1] == node.robot_address);
  }
  CHECK(addresses.size() == 2 * demo_robots().size() + 1);
}

TEST_CASE("demo: the ports that it holds are in its network, and another network is named") {
  const DemoFleet fleet = *demo_fleet("127.0.42", 0);
  const std::vector<DemoPort> ports = demo_ports(fleet);
  CHECK(ports.size() == 2 * demo_robots().size() + 1);
  for (const DemoPort& one : ports) CHECK(one.address.starts_with("127.0.42."));
  CHECK(network_json_of("x").find("\"TCP_PORT_EXT\": " + std::to_string(ports[0].port)) != std::string::npos);
  CHECK(next_network(fleet) == "127.0.43");
  CHECK(next_network(*demo_fleet("127.0.255", 0)) == "127.0.1");
}

TEST_CASE("demo: the cloud has a gateway only if a page is wanted") {
  CHECK(cloud_of(*demo_fleet("127.0.42", 0)).page.empty());
  CHECK(cloud_of(*demo_fleet("127.0.42", 8443)).page == "127.0.0.1:8443");
}

TEST_CASE("demo: another computer's network and ports that are none are refused by their option's name") {
  for (const std::string network : {"10.0.0", "127.0", "127.0.256", "127.0.1.1", "127.0.x", "127.0.042", ""}) {
    INFO(network);
    CHECK(demo_fleet(network, 0).error().what.find("--network") == 0);
  }
  for (const double port : {1.0, 443.0, 70000.0, 8443.5, -1.0, 1e30})
    CHECK(demo_fleet("127.0.42", port).error().what.find("--page") == 0);
  for (const double speed : {0.0, -1.0, 101.0, 1e300})
    CHECK(demo_fleet("127.0.42", 0, speed).error().what.find("--speed") == 0);
}

TEST_CASE("demo: what is kept of it gives the same fleet; a file that was changed is named") {
  const DemoFleet fleet = *demo_fleet_of(demo_json(*demo_fleet("127.0.42", 8443, 4)));
  CHECK(fleet.network == "127.0.42");
  CHECK(fleet.page_port == 8443);
  CHECK(fleet.speed == 4);
  CHECK(demo_fleet_of("{").error().what.find("demo.json") == 0);
  CHECK(demo_fleet_of("{\"network\": 5, \"page\": 0, \"speed\": 1}").error().code == Errc::bad_value);
  CHECK(demo_fleet_of("{\"network\": \"10.0.0\", \"page\": 0, \"speed\": 1}").error().code == Errc::bad_value);
}
