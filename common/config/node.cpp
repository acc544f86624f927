#include <algorithm>
#include <filesystem>

#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/base/number_text.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/readers.hpp"
#include "common/fleet/description_parts.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/security/services.hpp"

namespace trb {
namespace {

constexpr std::size_t kMaxSocketPath = 107;  ///< what sun_path holds
constexpr std::size_t kMaxSeeds = 1000;
constexpr std::size_t kMaxServices = 16;
constexpr std::size_t kMaxPath = 4096;
constexpr std::size_t kKeySize = 32;
constexpr std::int64_t kMinProofLogMb = 8;

bool is_address(std::string_view address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const std::string_view host = address.substr(0, colon);
  const std::string_view digits = address.substr(colon + 1);
  if (parse_number<std::uint16_t>(digits).value_or(0) == 0) return false;
  if (host.starts_with("[") && host.ends_with("]")) return is_ipv6(std::string(host.substr(1, host.size() - 2)));
  return host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_") ==
         std::string_view::npos;
}

Seed read_seed(const Value& json, const std::string& path, const FileFaults& faults) {
  ObjectReader reader(json, path, faults);
  Seed seed;
  seed.address = reader.text("address", Need::required, 80).value_or("");
  if (!seed.address.empty() && !is_address(seed.address)) {
    faults.add(path + ".address", in_quotes(seed.address) + " is no HOST:PORT",
               "write it as 10.0.0.1:45000, or [fd00::1]:45000");
  }
  if (const auto text = reader.text("key", Need::required)) {
    auto key = from_hex(*text);
    if (key && key->size() == kKeySize) {
      seed.key = std::move(*key);
    } else {
      faults.add(path + ".key", "is no link key of 64 hexadecimal digits", "copy it from trb fleet show");
    }
  }
  reader.refuse_unknown_keys();
  return seed;
}

void read_seeds(ObjectReader& reader, NodeConfig& config) {
  const auto* items = reader.list("seeds", Need::optional, kMaxSeeds);
  if (items == nullptr) return;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const std::string path = "seeds[" + std::to_string(i) + "]";
    Seed seed = read_seed((*items)[i], path, reader.faults());
    const bool again = std::any_of(config.seeds.begin(), config.seeds.end(),
                                   [&](const Seed& other) { return other.address == seed.address; });
    if (again && !seed.address.empty()) {
      reader.faults().add(path + ".address", in_quotes(seed.address) + " occurs twice", "keep one of them");
    }
    config.seeds.push_back(std::move(seed));
  }
}

void read_robot(ObjectReader& node, NodeConfig& config) {
  const Value* json = node.value("robot", Need::required);
  if (json == nullptr) return;
  ObjectReader reader(*json, "robot", node.faults());
  config.robot.host = reader.text("host", Need::required, 64).value_or("");
  config.robot.interface = reader.text("interface", Need::optional, 64).value_or("");
  config.robot.ros_namespace = reader.text("namespace", Need::optional, 64).value_or("");
  const std::string& space = config.robot.ros_namespace;
  if (!space.empty() && (!is_valid_word(space) || space.find('-') != std::string::npos)) {
    reader.faults().add("robot.namespace", in_quotes(config.robot.ros_namespace) + " is no ROS name",
                        "use letters, digits and '_', for example ridgeback");
  }
  if (const Value* origin = reader.value("origin", Need::optional)) {
    config.robot.origin = read_pose(*origin, "robot.origin", Need::required, node.faults());
  }
  config.robot.fault_injection = reader.text("fault_injection", Need::optional, 64).value_or("");
  reader.refuse_unknown_keys();
  const std::string& control = config.robot.fault_injection;
  if (!control.empty() && !(is_address(control) && is_ipv4(control.substr(0, control.rfind(':'))))) {
    node.faults().add("robot.fault_injection", in_quotes(control) + " is no address with a port",
                      "use the --control of the virtual robot, for example 127.0.0.1:6000; a real robot has none");
  }
  if (config.robot.host.empty() || is_ipv4(config.robot.host)) return;
  node.faults().add("robot.host", in_quotes(config.robot.host) + " is no IPv4 address",
                    "use the robot's address, for example 192.168.1.20");
}

void check_service(const std::string& name, const std::vector<std::string>& known, Role role,
                   const FileFaults& faults) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  if (role == Role::cloud && name == "mode-adapter") {
    return faults.add("services", "a cloud node has no robot, so no mode-adapter", "remove \"mode-adapter\"");
  }
  if (role == Role::robot && name == "cloud-gateway") {
    return faults.add("services", "a robot's node has no cloud-gateway", "name it in a cloud node's node.json");
  }
  faults.add("services", in_quotes(name) + " is no service of this version",
             did_you_mean(name, known, "put your own into \"own_services\", or use some of"));
}

void read_services(ObjectReader& reader, NodeConfig& config) {
  if (reader.value("services", Need::optional) == nullptr) {
    config.services = default_services_of(config.role);
    return;
  }
  const std::vector<std::string> known = services_of(config.role);
  config.services = reader.texts("services", Need::required, kMaxServices);
  for (const std::string& name : config.services) check_service(name, known, config.role, reader.faults());
  if (config.has_service("router")) return;
  reader.faults().add("services", "has no \"router\", the node's only door", "add \"router\"");
}

bool check_own_name(const std::string& name, const std::string& path, const FileFaults& faults) {
  const Status named = check_id("service", name);
  if (!named) faults.add(path, named.error().what, named.error().hint);
  const bool reserved = is_reserved_service(name);
  if (reserved) faults.add(path, in_quotes(name) + " is a name of the middleware's", "give it a name of your own");
  return named.ok() && !reserved;
}

/// The operator's services: under a key of their own, so that a typo in "services" is reported.
void read_own_services(ObjectReader& reader, NodeConfig& config) {
  const auto* members = reader.object("own_services", Need::optional, kMaxServices);
  if (members == nullptr) return;
  for (const auto& [name, program] : *members) {
    const std::string path = "own_services." + name;
    if (!check_own_name(name, path, reader.faults())) continue;
    config.services.push_back(name);
    if (!program.is_text() || program.text().empty() || program.text().size() > kMaxPath) {
      reader.faults().add(path, "is no path of a program",
                          R"(write "/opt/hall/bin/fault-tally", or a path relative to the node's folder)");
      continue;
    }
    config.own_services[name] = (std::filesystem::path(config.dir) / program.text()).lexically_normal().string();
  }
}

void refuse_robot(ObjectReader& reader) {
  for (const char* key : {"framework", "robot", "description"}) {
    if (reader.value(key, Need::optional) == nullptr) continue;
    reader.faults().add(key, "a cloud node has no robot", "remove it, or set \"role\" to \"robot\"");
  }
}

void read_archive(ObjectReader& reader, NodeConfig& config) {
  const auto size = reader.integer("archive_mb", Need::optional, 1, 65'536);
  if (size) config.archive_mb = static_cast<std::uint32_t>(*size);
}

void read_seals(ObjectReader& reader, NodeConfig& config) {
  config.seal_before_delivery = reader.choice("seal", Need::optional, {"behind", "before_delivery"}).value_or(0) == 1;
  const auto size = reader.integer("proof_log_mb", Need::optional, 0, 65'536);
  if (!size) return;
  config.proof_log_mb = static_cast<std::uint32_t>(*size);
  if (*size > 0 && *size < kMinProofLogMb) {
    reader.faults().add("proof_log_mb", std::to_string(*size) + " MB hold too little to prove anything",
                        "use 0 for no proof log, or at least " + std::to_string(kMinProofLogMb));
  }
}

/// The size without the %20 escapes of a D-Bus address.
std::size_t unescaped_size(std::string_view path) {
  const auto escapes = static_cast<std::size_t>(std::count(path.begin(), path.end(), '%'));
  return path.size() - std::min(2 * escapes, path.size());
}

void read_dbus(ObjectReader& reader, NodeConfig& config) {
  const auto text = reader.text("dbus", Need::optional, 400);
  if (!text) return;
  config.dbus = *text;
  constexpr std::string_view kPath = "unix:path=/";
  const bool is_path =
      text->starts_with(kPath) && text->size() > kPath.size() && text->find_first_of(",; ") == std::string::npos;
  if (is_path && unescaped_size(text->substr(kPath.size() - 1)) > kMaxSocketPath) {
    return reader.faults().add(
        "dbus", "its path is too long for a socket, which takes " + std::to_string(kMaxSocketPath) + " bytes",
        "give that bus a shorter path, as below /run");
  }
  if (*text == "system" || *text == "session" || is_path) return;
  reader.faults().add("dbus", in_quotes(*text) + " is no D-Bus",
                      R"(use "system", "session" or an address: "unix:path=/run/robot/bus")");
}

void read_id(ObjectReader& reader, NodeConfig& config, NodeFile& file) {
  const auto id = reader.text("id", Need::required);
  if (!id) return;
  config.id = *id;
  const Status good = check_id("id", *id);
  file.usable = good.ok();
  if (!good) reader.faults().add("id", good.error().what, good.error().hint);
}

}  // namespace

NodeFile read_node(const Value& json, NodeConfig& config, const FileFaults& faults) {
  ObjectReader reader(json, "", faults);
  NodeFile file;
  read_id(reader, config, file);
  config.role = reader.one_of<Role>("role", Need::optional).value_or(Role::robot);
  if (config.role == Role::cloud) {
    refuse_robot(reader);
  } else {
    config.framework = reader.text("framework", Need::required, kMaxIdSize).value_or("");
    file.description = reader.text("description", Need::required, 4096).value_or("");
    read_robot(reader, config);
  }
  read_seeds(reader, config);
  config.bus = read_bus_key(reader);
  read_dbus(reader, config);
  config.beacon = reader.boolean("beacon", Need::optional).value_or(true);
  config.relay = reader.boolean("relay", Need::optional).value_or(config.role == Role::cloud);
  read_seals(reader, config);
  read_archive(reader, config);
  read_services(reader, config);
  read_own_services(reader, config);
  reader.refuse_unknown_keys();
  return file;
}

bool NodeConfig::has_service(std::string_view name) const {
  return std::find(services.begin(), services.end(), name) != services.end();
}

}  // namespace trb
