#include "common/config/node_config.hpp"

#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "common/base/files.hpp"
#include "common/config/cloud_file.hpp"
#include "common/config/described_names.hpp"
#include "common/config/described_places.hpp"
#include "common/config/hall_picture.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/json_file.hpp"
#include "common/config/metrics_file.hpp"
#include "common/config/ports.hpp"
#include "common/config/readers.hpp"
#include "common/config/resilience_file.hpp"
#include "common/config/robot_auth.hpp"
#include "common/config/robot_tls.hpp"
#include "common/config/sensor_files.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/security/bus_keys.hpp"
#include "common/security/node_keys.hpp"

namespace trb {
namespace {

UtcTime utc_now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count()};
}

/// Reads a node's folder file by file; each member function reads one file, and none stops at a fault.
class NodeChecker {
 public:
  NodeChecker(const std::string& dir, const Transports& known) : known_(known) { out_.config.dir = absolute(dir); }

  NodeCheck check(bool running) && {
    const Status there = look_for(out_.config.dir + "/node.json");
    if (!there && there.error().code != Errc::missing) {
      sink("node.json").add("", there.error().what, there.error().hint);
      return std::move(out_);
    }
    std::error_code problem;
    if (!std::filesystem::is_directory(out_.config.dir, problem)) {
      sink(out_.config.dir).add("", "is no folder", "give the folder that holds node.json");
      return std::move(out_);
    }
    const NodeFile node = node_json();
    network_json();
    places_json();
    description(node);
    mode();
    check_described_names(out_.config, known_, node.description, out_.faults);
    read_sensor_files(out_.config.dir, out_.faults);
    read_resilience_file(out_.config.dir, out_.faults);
    const std::size_t before_cloud = out_.faults.size();
    const CloudSettings cloud = read_cloud_file(out_.config.dir, out_.faults);
    const bool cloud_good = out_.faults.size() == before_cloud;
    read_hall_picture(out_.config.dir, out_.faults);
    const std::vector<OwnPort> own = own_ports(cloud_good ? &cloud : nullptr);
    if (const auto metrics = read_metrics_file(out_.config.dir, out_.faults)) metrics_apart(*metrics, own);
    if (out_.config.has_service("mode-adapter")) check_robot_auth(out_.config.dir, out_.faults);
    if (out_.config.has_service("mode-adapter")) check_robot_trust(out_.config, out_.faults);
    if (node.usable) keys(running);
    if (!out_.config.bus.empty()) check_bus_keys(out_.config.dir, bus_names(out_.config), out_.faults);
    if (!running) ports(own);
    if (!running) own_programs();
    return std::move(out_);
  }

 private:
  static std::string absolute(const std::string& dir) {
    std::string out = std::filesystem::absolute(dir).lexically_normal().string();
    if (out.size() > 1 && out.back() == '/') out.pop_back();
    return out;
  }

  FileFaults sink(const std::string& file) { return {file, out_.faults}; }

  /// `hint` is for a missing file; an empty one means that the file is optional.
  std::optional<Value> load(const std::string& name, const std::string& hint) {
    return load_json((std::filesystem::path(out_.config.dir) / name).string(), hint, sink(name));
  }

  /// A file that only a robot's node needs.
  std::string for_robot(const std::string& hint) const { return out_.config.framework.empty() ? "" : hint; }

  NodeFile node_json() {
    const auto json =
        load("node.json", R"(write it: {"id": …, "framework": …, "description": …, "robot": {"host": …}})");
    return json ? read_node(*json, out_.config, sink("node.json")) : NodeFile{};
  }

  void network_json() {
    const auto json = load("network.json", "copy config/network.json to it and set HOST_INT");
    if (!json) return;
    out_.config.network = read_network(*json, sink("network.json"));
    resolve_network(out_.config, out_.faults);
  }

  void places_json() {
    const auto json = load("places.json", for_robot("copy config/places.json to it"));
    if (!json) return;
    out_.config.places = read_places(*json, "places.json", out_.faults);
    has_places_ = true;
  }

  void description(const NodeFile& node) {
    if (node.description.empty()) return;
    const auto json =
        load(node.description, "correct \"description\" in node.json, or copy a file of config/robots to it");
    if (json) out_.config.description = read_description(*json, node.description, out_.faults);
    check_place_names(out_.config.description, out_.config.places, sink("places.json"));
    if (has_places_)
      check_described_places(out_.config.description, out_.config.places, node.description, "places.json", out_.faults);
    if (out_.config.robot.origin) out_.config.description.frame.origin = *out_.config.robot.origin;
  }

  void mode() {
    NodeConfig& config = out_.config;
    const auto profile_json = load("profile.json", for_robot("copy config/profile.json to it"));
    if (!profile_json) return commands();
    const Profile profile = read_profile(*profile_json, sink("profile.json"));
    if (config.framework.empty()) return commands();
    const auto at = profile.find(config.framework);
    if (at == profile.end()) {
      std::vector<std::string> frameworks;
      for (const auto& [framework, ignored] : profile) frameworks.push_back(framework);
      sink("node.json")
          .add("framework", in_quotes(config.framework) + " is not in profile.json",
               did_you_mean(config.framework, frameworks, "add it there with its mode, or use one of"));
      return commands();
    }
    config.mode = at->second;
    if (config.mode == Mode::ros && !config.has_service("ros-bridge")) {
      sink("node.json")
          .add("services", "has no \"ros-bridge\", without which the ros mode says nothing",
               R"(write "services": ["router", "mode-adapter", "ros-bridge", "scheduler"])");
    }
    commands();
  }

  void commands() {
    NodeConfig& config = out_.config;
    const bool needed = config.mode == Mode::direct || config.mode == Mode::ros;
    const auto json = load("commands.json", needed ? "copy config/commands.json to it" : "");
    const AllCommands all = json ? read_commands(*json, known_, sink("commands.json")) : AllCommands();
    const auto at = all.find(config.framework);
    if (at != all.end()) config.commands = at->second;
    if (config.commands.transport.empty()) config.commands.transport = known_.default_of(config.mode);
    if (at != all.end() && config.mode != Mode::none) return known_.check(config, sink("commands.json"));
    if (!json || !needed) return;
    sink("commands.json")
        .add(config.framework, "is missing: this mode needs the vendor's words",
             "add \"" + config.framework + R"(": {"port": …, "commands": {"stop": …}})");
  }

  /// A service in a container of its own has a key for the bus, and no secret of the node.
  bool is_apart(bool running) const {
    return running && !out_.config.bus.empty() && !file_exists(out_.config.dir + "/keys/identity.key");
  }

  void keys(bool running) {
    const NodeConfig& config = out_.config;
    const std::size_t before = out_.faults.size();
    init_crypto();
    check_node_keys(config.dir, config.id, utc_now(), out_.faults, is_apart(running));
    if (out_.faults.size() != before) return;
    const auto keys = load_node_certificate(config.dir);
    if (!keys) return;
    add_seeds(keys->seeds);
    if (config.relay && !keys->certificate.relay) {
      sink("keys/certificate.json")
          .add("relay", "does not let this node relay, node.json wants it to",
               "trb fleet renew FLEET_DIR " + config.id + " --relay, or \"relay\": false in node.json");
      out_.faults.back().may_wait = true;
    }
    if (keys->certificate.role == config.role) return;
    sink("keys/certificate.json")
        .add("role",
             "is " + in_quotes(name_of(keys->certificate.role)) + ", node.json says " + in_quotes(name_of(config.role)),
             "correct \"role\" in node.json, or run trb fleet request and trb fleet sign again");
  }

  /// What came with the certificate, where node.json says nothing of that node.
  void add_seeds(const std::vector<FleetSeed>& seeds) {
    std::vector<Seed>& known = out_.config.seeds;
    for (const FleetSeed& seed : seeds) {
      const bool named = std::any_of(known.begin(), known.end(), [&](const Seed& one) {
        return one.key == seed.key.bytes || one.address == seed.address;
      });
      if (!named) known.push_back({seed.address, seed.key.bytes});
    }
  }

  /// A TCP port that the node's own programs open, and the key that names it.
  struct OwnPort {
    std::string file, key, address;
    std::uint16_t number = 0;
  };

  /// The page's only if cloud.json is good.
  std::vector<OwnPort> own_ports(const CloudSettings* cloud) const {
    const NodeConfig& config = out_.config;
    const Network& network = config.network;
    std::vector<OwnPort> out = {{"network.json", "TCP_PORT_EXT", network.address, network.tcp_port_ext}};
    if (network.lane_port != 0) out.push_back({"network.json", "LANE_PORT", network.address, network.lane_port});
    if (config.mode != Mode::none && config.has_service("mode-adapter"))
      out.push_back({"network.json", "TCP_PORT", network.robot_address, network.tcp_port});
    if (cloud != nullptr && config.has_service("cloud-gateway"))
      out.push_back({"cloud.json", "listen", cloud->address, cloud->port});
    return out;
  }

  /// The bus has two ports: messages, and the tap.
  std::vector<OwnPort> bus_ports() const {
    const Endpoint at = split_endpoint(out_.config.bus);
    if (at.host.empty()) return {};
    return {{"node.json", "bus", at.host, at.port},
            {"node.json", "bus", at.host, static_cast<std::uint16_t>(at.port + 1)}};
  }

  void ports(const std::vector<OwnPort>& own) {
    for (const OwnPort& one : own) (void)is_free(one);
    for (const OwnPort& one : bus_ports()) {
      if (!is_free(one)) break;
    }
  }

  /// What the node opens itself is never free for its metrics, or, if the metrics are there first, for the program that
  /// needs it.
  void metrics_apart(const MetricsAddress& metrics, std::vector<OwnPort> own) {
    for (OwnPort& one : bus_ports()) own.push_back(std::move(one));
    for (const OwnPort& one : own) {
      const bool is_there = one.address == metrics.address || one.address == "0.0.0.0";
      if (!is_there || one.number != metrics.port) continue;
      sink("metrics.json")
          .add("listen",
               metrics.address + ":" + std::to_string(metrics.port) + " is this node's own " + one.key + " of " +
                   one.file,
               "choose another port, as 9464");
      return;
    }
  }

  void own_programs() {
    for (const auto& [name, program] : out_.config.own_services) {
      std::error_code none;
      const bool starts = std::filesystem::is_regular_file(program, none) && ::access(program.c_str(), X_OK) == 0;
      if (starts) continue;
      sink("node.json")
          .add("own_services." + name, in_quotes(program) + " is no program that can be started",
               "build and install it, or correct the path (absolute, or relative to the node's folder)");
    }
  }

  bool is_free(const OwnPort& own) {
    if (own.address.empty()) return true;
    const Status free = check_tcp_port(own.address, own.number);
    if (free) return true;
    sink(own.file).add(own.key, free.error().what, free.error().hint);
    out_.faults.back().may_wait = free.error().code == Errc::missing;
    return false;
  }

  const Transports& known_;
  NodeCheck out_;
  bool has_places_ = false;  ///< places.json was read
};

}  // namespace

NodeCheck check_node_dir(const std::string& dir, bool running) {
  return check_node_dir(dir, running, Transports());
}

NodeCheck check_node_dir(const std::string& dir, bool running, const Transports& known) {
  return NodeChecker(dir, known).check(running);
}

}  // namespace trb
