#include "common/operator/io/doctor.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/config/interfaces.hpp"
#include "common/operator/io/machine_state.hpp"
#include "common/operator/io/socket_address.hpp"
#include "common/security/node_keys.hpp"

namespace trb::op {
namespace {

AddressProbe to_try(const std::string& address) {
  AddressProbe out;
  out.address = address;
  return out;
}

/// Only a router looks names up; and of what has a link nothing need be tried: there it would look like an intruder's
/// try.
bool may_be_tried(const AddressProbe& probe) {
  return is_numeric_endpoint(probe.address) && probe.port == Port::not_tried;
}

/// Only a way that carries something can carry too little.
bool carries_something(const AddressProbe& probe) {
  return probe.port == Port::zmtp && !probe.address.starts_with("127.");
}

}  // namespace

Doctor::Doctor(Loop& loop, Session* session, const Transports* known)
    : session_(session), known_(known), probes_(loop) {}

void Doctor::examine(const Patient& patient, Events events) {
  busy_ = true;
  events_ = std::move(events);
  seen_ = {};
  seen_.asked = patient.asked;
  seen_.bus_key_refused = patient.bus_key_refused;
  look_at_folder();
  look_for_sockets();
  progress("asking the router of " + seen_.node);
  ask(observe_router, &Doctor::try_bus);
}

void Doctor::look_at_folder() {
  NodeCheck check = known_ == nullptr ? check_node_dir(".", true) : check_node_dir(".", true, *known_);
  seen_.faults = std::move(check.faults);
  config_ = std::move(check.config);
  seen_.node = config_.id;
  seen_.beacon = config_.beacon;
  seen_.named = config_.services;
  seen_.has_robot = !config_.framework.empty();
  seen_.seeds = config_.seeds.size();
  seen_.now = read_clocks().utc;
  seen_.disk = disk_state(".");
  seen_.clock_set = is_clock_set();
  if (auto keys = load_node_keys(".")) seen_.own = keys->certificate;
}

void Doctor::look_for_sockets() {
  std::vector<std::string> names = config_.services;
  names.insert(names.end(), {"probe", "tap"});
  for (const std::string& name : names) {
    const std::string path = "bus/" + name + ".ipc";
    if (config_.bus.empty() && name != "router" && !file_exists(path)) seen_.missing_sockets.push_back(path);
  }
}

void Doctor::ask(void (*add)(Session&, Observed, const ObservedNext&), Next next) {
  if (session_ == nullptr) return (this->*next)();
  add(*session_, std::move(seen_), [this, next](Observed seen) {
    seen_ = std::move(seen);
    (this->*next)();
  });
}

/// The router's own ports: of its bus, if that is TCP, and for other routers.
void Doctor::try_bus() {
  std::vector<AddressProbe> bus;
  if (const Endpoint at = split_endpoint(config_.bus); !at.host.empty()) {
    for (const int further : {0, 1}) {
      bus.push_back(to_try(join_host_port(at.host, static_cast<std::uint16_t>(at.port + further))));
    }
  }
  probes_.try_ports(std::move(bus), [this](const std::vector<AddressProbe>& tried) {
    for (const AddressProbe& probe : tried) {
      if (probe.port != Port::zmtp) seen_.missing_sockets.push_back("tcp://" + probe.address);
    }
    try_inbox();
  });
}

void Doctor::try_inbox() {
  const Network& network = config_.network;
  if (network.address.empty() || seen_.answers) return find_addresses();
  probes_.try_ports({to_try(join_host_port(network.address, network.tcp_port_ext))},
                    [this](const std::vector<AddressProbe>& tried) {
                      seen_.inbox_open = tried.front().port == Port::zmtp;
                      find_addresses();
                    });
}

void Doctor::find_addresses() {
  std::vector<std::string> seeds;
  for (const Seed& seed : config_.seeds) seeds.push_back(seed.address);
  seen_.addresses = addresses_to_try(seen_, seeds, in_own_subnet);
  progress("trying " + std::to_string(seen_.addresses.size()) + " addresses");
  std::stable_partition(seen_.addresses.begin(), seen_.addresses.end(), may_be_tried);
  try_some(may_be_tried, &AddressProbes::try_ports, &Doctor::try_datagrams);
}

void Doctor::try_datagrams() {
  try_some(carries_something, &AddressProbes::try_datagrams, &Doctor::ask_peers);
}

/// Those addresses that `wanted` is true of, tried; the others stay as they are.
void Doctor::try_some(bool (*wanted)(const AddressProbe&), Begin begin, Next next) {
  std::vector<AddressProbe> some;
  std::ranges::copy_if(seen_.addresses, std::back_inserter(some), wanted);
  (probes_.*begin)(std::move(some), [this, next](const std::vector<AddressProbe>& tried) {
    for (const AddressProbe& one : tried)
      *std::ranges::find(seen_.addresses, one.address, &AddressProbe::address) = one;
    (this->*next)();
  });
}

void Doctor::ask_peers() {
  ask(observe_links, &Doctor::try_robot);
}

/// A controller may take one connection only: it is tried when the node has none.
void Doctor::try_robot() {
  if (config_.mode != Mode::direct || config_.robot.host.empty() || !config_.commands.port) return finish();
  seen_.robot.address = config_.robot.host + ":" + std::to_string(*config_.commands.port);
  const auto self = std::ranges::find(seen_.routes.routes, "self", &Route::state);
  if (self == seen_.routes.routes.end() || self->profile.robot == "ONLINE") return finish();
  probes_.try_ports({to_try(seen_.robot.address)}, [this](const std::vector<AddressProbe>& tried) {
    seen_.robot.port = tried.front().port;
    finish();
  });
}

void Doctor::finish() {
  busy_ = false;
  Examination out{std::move(seen_), {}};
  out.findings = diagnose(out.seen);
  std::exchange(events_, {}).done(std::move(out));
}

void Doctor::progress(const std::string& text) const {
  if (events_.progress) events_.progress(text);
}

}  // namespace trb::op
