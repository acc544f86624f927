// node new: a folder for a robot's or a cloud node, with a line at each value that says where to find it.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <functional>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/base/ids.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/supervisor/process.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/node_new.hpp"
#include "services/cli/core/new_node.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/questions.hpp"

namespace trb::cli {
namespace {

/// The value of an option, else what the person answers, else an error that names the option.
Result<std::string> wanted(const Arguments& arguments, const std::string& option, const std::string& question,
                           const std::string& known = {}) {
  if (arguments.has(option)) return arguments.get(option);
  if (!can_ask()) return known.empty() ? Result<std::string>(fail(Errc::missing, option + ": " + question)) : known;
  std::string said = ask(question, known);
  if (said.empty()) return fail(Errc::missing, option + ": nothing was answered", "give " + option);
  return said;
}

/// This computer's own address on the way to the robot, as its routes have it; empty: there is no way.
std::string address_towards(const std::string& robot) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return {};
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(9);  // nothing is sent
  sockaddr_in own{};
  socklen_t size = sizeof own;
  char text[INET_ADDRSTRLEN] = "";
  if (::inet_pton(AF_INET, robot.c_str(), &to.sin_addr) == 1 &&
      ::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 &&
      ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size) == 0) {
    ::inet_ntop(AF_INET, &own.sin_addr, text, sizeof text);
  }
  ::close(socket);
  return text;
}

/// Interfaces on which the fleet may be: up, with an IPv4 address, of other machines.
std::vector<std::string> networks(const std::string& robot_side) {
  std::vector<std::string> out;
  for (const Interface& one : interfaces()) {
    const bool may_be = one.up && is_ipv4(one.address) && !one.address.starts_with("127.") && one.address != robot_side;
    if (may_be && std::ranges::find(out, one.name) == out.end()) out.push_back(one.name);
  }
  return out;
}

Result<NewNode> new_node_of(const Arguments& arguments) {
  NewNode node;
  auto id = wanted(arguments, "--robot", "the robot's name in the fleet");
  if (!id) return id.error();
  if (Status good = check_id("--robot", *id); !good) return good.error();
  std::string likes;
  for (const RobotKind& kind : robot_kinds()) likes += (likes.empty() ? "" : ", ") + std::string(kind.like);
  auto like = wanted(arguments, "--like", "what robot it is like (" + likes + ")");
  if (!like) return like.error();
  auto kind = robot_kind(*like);
  if (!kind) return kind.error();
  auto address = wanted(arguments, "--address", "the robot's address: " + std::string(kind->address_at));
  if (!address) return address.error();
  if (!is_ipv4(*address)) {
    return fail(Errc::bad_value, "--address: " + in_quotes(*address) + " is no IPv4 address",
                std::string(kind->address_at) + "; for example 192.168.1.5");
  }
  node.id = *id;
  node.kind = *kind;
  node.robot_address = *address;
  node.robot_side = arguments.get("--interface", address_towards(*address));
  auto side = fleet_side_of(arguments, node.robot_side);
  if (!side) return side.error();
  node.fleet_side = *side;
  return node;
}

/// What is left to be put right, but for the certificate, which is the next step.
ConfigFaults faults_left(const std::string& dir) {
  ConfigFaults faults = check_node_dir(dir, false, drivers::robot_transports()).faults;
  std::erase_if(faults, [](const ConfigFault& one) { return one.what.find("certificate.json") != std::string::npos; });
  return faults;
}

void print_next_steps(const NewNode& node, const std::string& dir) {
  const std::string robot = dir + "/robots/" + std::string(node.kind.description);
  print_line("made " + dir + ": the node of '" + node.id + "', like " + std::string(node.kind.like) + " (" +
             std::string(node.kind.maker) + "), at " + node.robot_address + "; the fleet on " + node.fleet_side);
  print_line("next:");
  print_line("  the robot needs     " + std::string(node.kind.prepare));
  print_line("  what it can do      " + robot + ", then trb robot check " + robot);
  print_line("  its certificate     where the authority's folder is: trb fleet invite FLEET_DIR " + node.id +
             "; here: trb node join " + dir + " (it asks for the code)");
  print_line("                      (or copy files: trb fleet sign FLEET_DIR " + dir + "/keys/request.json)");
  print_line("  try and start it    trb check " + dir + "; trb up " + dir);
}

/// --cloud and --page say all of a cloud node; the page's program has a package of its own.
Result<NewCloud> new_cloud_of(const Arguments& arguments) {
  for (const char* option : {"--robot", "--like", "--address", "--interface"}) {
    if (arguments.has(option))
      return fail(Errc::bad_value, std::string(option) + ": a cloud node has no robot", "leave it out, or --cloud");
  }
  NewCloud cloud{arguments.get("--cloud"), {}, arguments.get("--page")};
  if (Status good = check_id("--cloud", cloud.id); !good) return good.error();
  if (arguments.has("--page") && !is_numeric_endpoint(cloud.page)) {
    return fail(Errc::bad_value, "--page: " + in_quotes(cloud.page) + " is no numeric HOST:PORT",
                "127.0.0.1:8443 for this computer alone, 0.0.0.0:8443 for every network");
  }
  const std::string gateway = supervisor::program_dir() + "/trb-cloud-gateway";
  if (arguments.has("--page") && !file_exists(gateway))
    return fail(Errc::missing, "--page: " + gateway + " is not there", "install the package talkrobots-cloud");
  auto side = fleet_side_of(arguments, {});
  if (!side) return side.error();
  cloud.fleet_side = *side;
  return cloud;
}

int print_made(const Arguments& arguments, const std::string& dir, const char* what, const std::string& id,
               const std::function<void()>& next_steps) {
  const ConfigFaults left = faults_left(dir);
  if (arguments.has("--json")) {
    print_json(
        Value{Value::Object{{"dir", Value{dir}}, {what, Value{id}}, {"faults", *faults_json(left).find("faults")}}});
    return kGood;
  }
  next_steps();
  if (!left.empty()) print("not good yet:\n" + to_text(left));
  return kGood;
}

void print_next_steps(const NewCloud& cloud, const std::string& dir) {
  print_line("made " + dir + ": the cloud node '" + cloud.id + "'; the fleet on " + cloud.fleet_side +
             (cloud.page.empty() ? "; it has no page (--page)" : "; the page at " + cloud.page));
  print_line("next:");
  print_line("  its certificate     where the authority's folder is: trb fleet sign FLEET_DIR request.json of " + dir +
             "/keys;");
  print_line("                      certificate.json goes into " + dir + "/keys");
  print_line("                      (or, if another cloud node is up: trb fleet invite FLEET_DIR " + cloud.id +
             " --role cloud)");
  print_line("  the hall's places   " + dir + "/places.json, the same as on the robots' nodes");
  print_line("  try and start it    trb check " + dir + "; trb up " + dir);
  if (!cloud.page.empty()) print_line("  the first sign-in   trb cloud password " + dir);
}

int run_new_cloud(const Arguments& arguments, const std::string& dir, const std::string& config) {
  const auto cloud = new_cloud_of(arguments);
  if (!cloud) return print_error(arguments, cloud.error());
  if (Status made = make_cloud_folder(*cloud, dir, config); !made) return print_error(arguments, made.error());
  return print_made(arguments, dir, "cloud", cloud->id, [&] { print_next_steps(*cloud, dir); });
}

int run_new(const Arguments& arguments) {
  const std::string dir = plain_folder(arguments.words[0]);
  auto config = config_dir();
  if (!config) return print_error(arguments, config.error());
  if (arguments.has("--cloud")) return run_new_cloud(arguments, dir, *config);
  if (arguments.has("--page"))
    return print_error(arguments, fail(Errc::bad_value, "--page: only a cloud node has one", "add --cloud NAME"));
  auto node = new_node_of(arguments);
  if (!node) return print_error(arguments, node.error());
  if (Status made = make_node_folder(*node, dir, *config); !made) return print_error(arguments, made.error());
  return print_made(arguments, dir, "robot", node->id, [&] { print_next_steps(*node, dir); });
}

}  // namespace

Result<std::string> fleet_side_of(const Arguments& arguments, const std::string& robot_side) {
  std::vector<std::string> known = networks(robot_side);
  if (known.empty()) known = networks({});  // one network for both
  const std::string only = known.size() == 1 ? known.front() : "";
  auto side = wanted(arguments, "--network",
                     "this computer's interface or address on the fleet's network (there are " +
                         (known.empty() ? "none now" : join(known)) + ")",
                     only);
  if (side && is_ipv6(*side)) return side;
  if (side && (is_ipv4(*side) || is_valid_id(*side))) return side;
  return side ? fail(Errc::bad_value, "--network: " + in_quotes(*side) + " is no interface and no address",
                     "ip address lists them")
              : side;
}

std::vector<Command> node_new_commands() {
  return {
      {{"node", "new"},
       {"node new DIR",
        "Makes the folder of a robot's or a cloud node: files that trb check passes once it has a certificate, each "
        "value\n"
        "with a line that says where to find it, and the node's keys. What is missing is asked for at a terminal.",
        {"--robot NAME|its name in the fleet",
         "--like KIND|ur, abb, kuka, pioneer, drone, mir, dobot, plc, ros or fields",
         "--address HOST|the robot's IPv4 address", "--network NAME|interface or address on the fleet's network",
         "--interface NAME|interface or address towards the robot (by this computer's routes)",
         "--cloud NAME|a cloud node of this name, instead of a robot's",
         "--page HOST:PORT|of a cloud node: with the page, which listens there", kJson},
        {"trb node new nodes/arm1 --robot arm1 --like ur --address 192.168.1.5", "trb node new nodes/arm1",
         "trb node new nodes/cloud --cloud cloud --page 0.0.0.0:8443"},
        1,
        1},
       run_new}};
}

}  // namespace trb::cli
