#include "services/cli/core/new_node.hpp"

#include <doctest/doctest.h>

#include "proto/value.hpp"

using namespace trb;
using namespace trb::cli;

TEST_CASE("new node: each kind has a name of its own, a description and a place for its address") {
  for (const RobotKind& kind : robot_kinds()) {
    CHECK(robot_kind(std::string(kind.like))->framework == kind.framework);
    CHECK_FALSE(kind.address_at.empty());
    CHECK_FALSE(kind.prepare.empty());
    CHECK(kind.description.ends_with(".json"));
  }
}

TEST_CASE("new node: a robot like none is refused, with the nearest") {
  CHECK(robot_kind("kuak").error().hint == "did you mean 'kuka'?");
  CHECK(robot_kind("fanuc").error().hint.find("ur, abb, kuka") != std::string::npos);
  CHECK(robot_kind("").error().code == Errc::bad_value);
}

TEST_CASE("new node: every value stands behind a line that says what it is") {
  const NewNode node{"arm1", *robot_kind("ur"), "10.0.0.5", "eth1", "eth0"};
  const std::string text = node_json_of(node);
  CHECK(text.find("teach pendant") < text.find("\"host\": \"10.0.0.5\""));
  CHECK(text.find("\"interface\": \"eth1\"\n") != std::string::npos);
  CHECK(text.find("ros-bridge") == std::string::npos);
  CHECK(text.find("fault_injection") == std::string::npos);
  const NewNode virtual_one{"arm1", *robot_kind("ur"), "127.0.0.5", "127.0.0.1", "127.0.0.1", "127.0.0.5:46000"};
  CHECK(node_json_of(virtual_one).find("\"fault_injection\": \"127.0.0.5:46000\"\n") != std::string::npos);
  CHECK(network_json_of("eth0").find("\"HOST_INT\": \"eth0\"") != std::string::npos);
  CHECK(node_json_of({"r", *robot_kind("ros"), "10.0.0.5", "", "eth0"}).find("\"ros-bridge\"") != std::string::npos);
}

TEST_CASE("new node: the line at seeds shows them in the form that is taken") {
  for (const std::string& text :
       {node_json_of({"arm1", *robot_kind("ur"), "10.0.0.5", "", "eth0"}), node_json_of(NewCloud{"cloud", "eth0"})}) {
    const auto json = parse_json(text);
    REQUIRE(json.ok());
    CHECK(text.find(R"([{\"address\": \"10.0.0.1:45000\", \"key\": \")") != std::string::npos);
  }
}

TEST_CASE("new node: a cloud node has the page's service and file only if a page is wanted") {
  CHECK(node_json_of(NewCloud{"cloud", "eth0"}).find("\"resilience\"]") != std::string::npos);
  const NewCloud cloud{"cloud", "eth0", "0.0.0.0:8443"};
  CHECK(node_json_of(cloud).find("\"role\": \"cloud\"") != std::string::npos);
  CHECK(node_json_of(cloud).find("\"cloud-gateway\"]") != std::string::npos);
  CHECK(cloud_json_of(cloud).find("\"listen\": \"0.0.0.0:8443\"") != std::string::npos);
}
