#include "services/cli/core/demo_fleet.hpp"

#include <cmath>
#include <optional>

#include "common/base/number_text.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"

namespace trb::cli {
namespace {

constexpr DemoRobot kRobots[] = {{"rover", "pioneer", "trb-virtual-pioneer"}, {"arm", "ur", "trb-virtual-ur"}};
constexpr std::size_t kFirstRobot = 101;
constexpr std::uint16_t kRouterPort = 45000;  ///< TCP_PORT_EXT of new nodes
constexpr std::uint16_t kFaultPort = 46000;

constexpr std::string_view kScenario = R"({
  "_comment": "The rover drives to table1; then the arm picks up a box. README.md of deploy/handbook begins with it.",
  "name": "first",
  "tasks": [
    { "id": "drive", "robot": "rover", "skill": "go_to", "data": { "place": "table1" } },
    { "id": "pick", "robot": "arm", "skill": "pick", "data": { "side": "left" }, "after": ["drive"] }
  ]
}
)";

/// The number of a part of an address, written as it is usual.
std::optional<unsigned> part(const std::string& text) {
  const auto number = parse_number<unsigned>(text);
  return number && *number <= 255 && std::to_string(*number) == text ? std::optional(*number) : std::nullopt;
}

bool is_loopback_network(const std::string& text) {
  const std::size_t first = text.find('.');
  const std::size_t second = first == std::string::npos ? first : text.find('.', first + 1);
  if (second == std::string::npos || text.substr(0, first) != "127") return false;
  return part(text.substr(first + 1, second - first - 1)) && part(text.substr(second + 1));
}

std::string node_address(const DemoFleet& fleet, std::size_t number) {
  return fleet.network + "." + std::to_string(number);
}
std::string robot_address(const DemoFleet& fleet, std::size_t robot) {
  return node_address(fleet, kFirstRobot + robot);
}

std::string fault_address(const DemoFleet& fleet, std::size_t robot) {
  return robot_address(fleet, robot) + ":" + std::to_string(kFaultPort);
}

}  // namespace

std::span<const DemoRobot> demo_robots() {
  return kRobots;
}

Result<DemoFleet> demo_fleet(const std::string& network, double page_port, double speed) {
  if (!is_loopback_network(network)) {
    return fail(Errc::bad_value,
                "--network: " + in_quotes(network) + " is not the beginning of an address of this computer",
                "three numbers, as 127.0.42");
  }
  const bool good = page_port == 0 || (page_port >= 1024 && page_port <= 65535 && page_port == std::floor(page_port));
  if (!good) return fail(Errc::bad_value, "--page: it must be a port from 1024 to 65535", "8443 is usual");
  if (!(speed >= 0.1 && speed <= 100)) return fail(Errc::bad_value, "--speed: from 0.1 to 100", "1 is a real robot's");
  return DemoFleet{network, static_cast<unsigned>(page_port), speed};
}

std::string demo_json(const DemoFleet& fleet) {
  return "{ \"network\": \"" + fleet.network + "\", \"page\": " + std::to_string(fleet.page_port) +
         ", \"speed\": " + std::to_string(fleet.speed) + " }\n";
}

Result<DemoFleet> demo_fleet_of(std::string_view text) {
  const auto json = parse_json(text);
  if (!json) return fail(json.error().code, "demo.json: " + json.error().what, "remove the folder, and make it anew");
  const Value* network = json->find("network");
  const Value* page = json->find("page");
  const Value* speed = json->find("speed");
  const auto is_number = [](const Value* value) { return value != nullptr && value->is_number(); };
  if (network == nullptr || !network->is_text() || !is_number(page) || !is_number(speed))
    return fail(Errc::bad_value, "demo.json: it needs network, page and speed", "remove the folder, and make it anew");
  return demo_fleet(network->text(), page->number(), speed->number());
}

NewNode node_of(const DemoFleet& fleet, std::size_t robot) {
  const std::string side = node_address(fleet, 2 + robot);
  const DemoRobot& one = kRobots[robot];
  return {std::string(one.id),        *robot_kind(std::string(one.like)), robot_address(fleet, robot), side, side,
          fault_address(fleet, robot)};
}

std::vector<std::string> robot_arguments(const DemoFleet& fleet, std::size_t robot) {
  return {"--address", robot_address(fleet, robot), "--control",        fault_address(fleet, robot),
          "--speed",   std::to_string(fleet.speed), "--die-with-parent"};
}

NewCloud cloud_of(const DemoFleet& fleet) {
  const std::string page = fleet.page_port == 0 ? "" : "127.0.0.1:" + std::to_string(fleet.page_port);
  return {std::string(kDemoCloud), node_address(fleet, 1), page};
}

std::vector<DemoPort> demo_ports(const DemoFleet& fleet) {
  std::vector<DemoPort> out{{cloud_of(fleet).fleet_side, kRouterPort}};
  for (std::size_t i = 0; i < demo_robots().size(); ++i) {
    out.push_back({node_of(fleet, i).fleet_side, kRouterPort});
    out.push_back({robot_address(fleet, i), kFaultPort});
  }
  return out;
}

std::string next_network(const DemoFleet& fleet) {
  const std::size_t dot = fleet.network.rfind('.');
  const unsigned last = part(fleet.network.substr(dot + 1)).value_or(0);
  return fleet.network.substr(0, dot + 1) + std::to_string(last % 255 + 1);
}

std::string_view demo_scenario() {
  return kScenario;
}

}  // namespace trb::cli
