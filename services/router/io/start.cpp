#include "services/router/io/start.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/metrics_file.hpp"
#include "common/config/node_config.hpp"
#include "common/log/log.hpp"
#include "common/security/bus_keys.hpp"
#include "common/security/node_keys.hpp"
#include "common/security/stored_updates.hpp"
#include "common/service/version.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/signals.hpp"
#include "proto/body.hpp"
#include "services/router/io/memory_return.hpp"
#include "services/router/io/router_shell.hpp"

namespace trb::router {
namespace {

constexpr const char* kRaise = "raise the limit (LimitNOFILE= of its systemd unit, ulimit -Hn)";

std::uint64_t stored_number(const std::string& path) {
  auto text = read_file(path, 64);
  if (!text && text.error().code != Errc::missing) log_event(Level::warning, "not_read", text.error().text());
  return text ? std::strtoull(text->c_str(), nullptr, 10) : 0;
}

/// A stored time out of the range of nanoseconds is ignored.
UtcTime stored_time(const std::string& path) {
  const std::uint64_t ns = stored_number(path);
  constexpr std::uint64_t kMost = 1ULL << 62U;
  return {ns < kMost ? static_cast<std::int64_t>(ns) : 0};
}

/// The boot counter increases at each start: by it peers tell an old process from a new one. It is the seconds of UTC
/// if the clock can be right, so that it also increases for a node whose state folder was lost, or whose disk is full:
/// to stop the robot there must be a router.
std::uint64_t count_boot(UtcTime now, UtcTime bound) {
  const std::uint64_t boot = stored_number(kBootFile) + 1;
  return now >= bound ? std::max(boot, static_cast<std::uint64_t>(now.ns / 1'000'000'000)) : boot;
}

/// The peers of the last run, as StorePeers wrote them. They are hints: a line that cannot be read is skipped.
std::vector<SeedAddress> read_known() {
  std::vector<SeedAddress> out;
  auto text = read_file("state/peers", kMaxPeers * 256);
  if (!text) return out;
  std::istringstream lines(*text);
  std::string address;
  std::string key;
  while (out.size() < kMaxPeers && lines >> address >> key) {
    auto bytes = from_hex(key);
    if (address.size() <= 80 && bytes && bytes->size() == 32) out.push_back({address, std::move(*bytes)});
  }
  return out;
}

/// What the authority had signed before this start. Damaged or unreadable, it must not count as nothing: who was
/// revoked would be a member again, until a peer comes who knows better.
void restore_updates(RouterConfig& config) {
  auto stored = read_stored_updates(".", config.authority);
  if (!stored) {
    config.updates_lost = stored.error();
    return;
  }
  if (stored->damaged) log_event(Level::warning, "copy_used", stored->damaged->text() + "; its copy is in force");
  config.updates = std::move(stored->update);
  config.dropped = std::move(stored->dropped);
}

RouterConfig make_config(const NodeConfig& node, const NodeKeys& keys, std::uint64_t boot) {
  RouterConfig config;
  config.id = node.id;
  config.role = keys.certificate.role;
  config.authority = keys.authority;
  config.certificate = keys.certificate_record;
  config.own = keys.certificate;
  config.identity = keys.identity;
  config.link_key = keys.link;
  const std::string& address = node.network.address;
  if (!address.empty()) config.address = join_host_port(without_scope(address), node.network.tcp_port_ext);
  config.boot = boot;
  config.instance = random_u64();
  config.pid = static_cast<std::uint32_t>(::getpid());
  config.first_slot = static_cast<std::uint16_t>(random_u64());
  config.version = kVersion;
  for (const trb::Seed& seed : node.seeds) config.seeds.push_back({seed.address, seed.key});
  config.known = read_known();
  config.services = node.services;
  config.beacon = node.beacon;
  config.seal_before_delivery = node.seal_before_delivery;
  config.relay = node.relay;
  return config;
}

/// Includes what earlier starts left in state/, and stores this start's boot number there.
RouterConfig restored_config(const NodeConfig& node, const NodeKeys& keys) {
  const UtcTime bound = stored_time("state/utc");
  const std::uint64_t boot = count_boot(read_clocks().utc, std::max(bound, UtcTime{keys.certificate.not_before}));
  RouterConfig config = make_config(node, keys, boot);
  config.boot_stored = write_boot(boot);
  config.utc_bound = bound;
  restore_updates(config);
  return config;
}

/// Errors: those of the keys.
Result<TcpBus> read_tcp_bus(const NodeConfig& node) {
  TcpBus bus;
  if (node.bus.empty()) return bus;
  const Endpoint at = split_endpoint(node.bus);
  bus.endpoint = "tcp://" + join_host_port(at.host, at.port);
  bus.tap = "tcp://" + join_host_port(at.host, static_cast<std::uint16_t>(at.port + 1));
  auto own = load_bus_key(".", kBusRouter);
  if (!own) return own.error();
  bus.keys = {own->public_key, own->secret_key};
  for (const std::string& name : bus_names(node)) {
    if (name == kBusRouter) continue;
    auto key = load_bus_public(".", name);
    if (!key) return key.error();
    if (!bus.names.emplace(*key, name).second) {
      return fail(Errc::duplicate, "keys/bus: " + name + ".pub is another one's too", "give each name keys of its own");
    }
  }
  return bus;
}

/// Errors: those of the keys of a bus over TCP.
Result<ShellOptions> make_options(const NodeConfig& node, const NodeKeys& keys, std::size_t descriptors) {
  auto bus = read_tcp_bus(node);
  if (!bus) return bus.error();
  ShellOptions options;
  options.link_keys = {keys.link.public_key, keys.link.secret_key};
  options.host_int = node.network.host_int;
  options.vpn_int = node.network.vpn_int;
  options.port = node.network.tcp_port_ext;
  options.lane_port = node.network.lane_port;
  options.beacon_port = node.network.udp_port;
  options.beacon_key = keys.beacon;
  options.pending_connections = limits_for(descriptors);
  ConfigFaults told;  // by service_main
  options.metrics = read_metrics_file(".", told);
  options.proof_log_bytes = std::uint64_t{node.proof_log_mb} << 20U;
  options.bus = std::move(*bus);
  return options;
}

/// As many descriptors as the system allows. Errors: io_error, too few.
Result<std::size_t> take_descriptors() {
  const std::size_t descriptors = raise_descriptor_limit();
  if (descriptors >= kLeastDescriptors) return descriptors;
  return fail(Errc::io_error,
              "at most " + std::to_string(descriptors) + " open files are allowed, at least " +
                  std::to_string(kLeastDescriptors) + " are needed",
              kRaise);
}

Status enter_folder(const std::string& dir) {
  if (::chdir(dir.c_str()) != 0) return fail(Errc::io_error, dir + ": no such folder");
  for (const char* folder : {"log", "state"}) {
    if (Status made = make_private_dir(folder); !made) return made;
  }
  for (const char* folder : {".", "keys", "keys/bus", "state"}) remove_unfinished_files(folder);
  return Done{};
}

}  // namespace

Result<int> start(NodeConfig node) {
  MemoryReturn::set_up();
  block_signals();
  const auto descriptors = take_descriptors();
  if (!descriptors) return descriptors.error();
  if (Status entered = enter_folder(node.dir); !entered) return entered.error();
  open_log("router", "log/router.log");
  auto keys = load_node_keys(".");
  if (!keys) return keys.error();
  RouterConfig config = restored_config(node, *keys);
  auto options = make_options(node, *keys, *descriptors);
  if (!options) return options.error();
  if (*descriptors < kGoodDescriptors) {
    log_event(Level::warning, "few_descriptors",
              "at most " + std::to_string(*descriptors) + " open files: strangers get " +
                  std::to_string(options->pending_connections.open) + " of them, which may be few for a large fleet; " +
                  kRaise);
  }
  RouterShell shell(std::move(config), *options);
  if (Status opened = shell.open(); !opened) return opened.error();
  return shell.run();
}

}  // namespace trb::router
