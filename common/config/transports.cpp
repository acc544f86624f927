// Which transports there are, in which mode each is spoken, and what each asks of commands.json.
#include <algorithm>
#include <array>

#include "common/config/readers.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb {
namespace {

void check_nothing(const NodeConfig&, const FileFaults&) {}

struct Transport {
  std::string_view name;
  Mode mode{};
  void (*check)(const NodeConfig&, const FileFaults&) = nullptr;
};

// A mode's first transport is the one that is meant where commands.json names none.
constexpr std::array<Transport, 8> kTransports{{
    {"tcp-text", Mode::direct, check_tcp_text},
    {"udp-at", Mode::direct, check_udp_at},
    {"modbus", Mode::direct, check_modbus},
    {"lines", Mode::interpreter, check_nothing},
    {"rapid", Mode::interpreter, check_rapid},
    {"c3", Mode::interpreter, check_c3},
    {"arcos", Mode::interpreter, check_arcos},
    {"ros", Mode::ros, check_ros},
}};

std::string transports_of(Mode mode) {
  std::string names;
  for (const Transport& transport : kTransports) {
    if (transport.mode == mode) names += (names.empty() ? "" : ", ") + std::string(transport.name);
  }
  return names;
}

}  // namespace

std::vector<std::string> transport_names() {
  std::vector<std::string> names;
  for (const Transport& transport : kTransports) names.emplace_back(transport.name);
  return names;
}

std::string default_transport(Mode mode) {
  const auto* const found = std::ranges::find(kTransports, mode, &Transport::mode);
  return found == kTransports.end() ? std::string() : std::string(found->name);
}

void check_transport(const NodeConfig& config, const FileFaults& faults) {
  const auto* const found = std::ranges::find(kTransports, config.commands.transport, &Transport::name);
  if (found == kTransports.end()) return;
  if (found->mode == config.mode) return found->check(config, faults);
  faults.add(config.framework + ".transport",
             in_quotes(found->name) + " is of the " + std::string(name_of(found->mode)) +
                 " mode, and profile.json says " + in_quotes(name_of(config.mode)),
             "use one of " + transports_of(config.mode) + ", or correct profile.json");
}

void require_port(const NodeConfig& config, const FileFaults& faults, const std::string& example) {
  if (config.commands.port) return;
  faults.add(config.framework + ".port", "is missing: the node dials a port of the robot",
             "add \"port\", for example " + example);
}

}  // namespace trb
