// doctor: looks at a node's folder, services, links and robot, and names what is wrong.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>

#include "common/base/address.hpp"
#include "common/base/files.hpp"
#include "common/config/interfaces.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"
#include "common/operator/doctor/observe.hpp"
#include "common/operator/io/address_probes.hpp"
#include "common/operator/io/socket_address.hpp"
#include "common/security/node_keys.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

using op::AddressProbe;
using op::Finding;
using op::LargeDatagram;
using op::Observed;
using op::Port;
using op::Weight;

/// Says on a terminal what is being waited for.
void progress(const Arguments& arguments, const std::string& text) {
  if (!arguments.has("--json") && ::isatty(STDERR_FILENO) == 1) print_problem("trb: " + text + " ...\n");
}

void look_at_folder(const std::string& dir, Observed& seen, NodeConfig& config) {
  NodeCheck check = check_node_dir(dir, true, drivers::robot_transports());
  seen.faults = std::move(check.faults);
  config = std::move(check.config);
  seen.node = config.id;
  seen.beacon = config.beacon;
  seen.seeds = config.seeds.size();
  seen.now = read_clocks().utc;
  if (auto keys = load_node_keys(dir)) seen.own = keys->certificate;
}

/// Tries addresses, while the loop keeps the link to the router alive.
class AddressTests {
 public:
  explicit AddressTests(Loop& loop) : loop_(loop), probes_(loop) {}

  std::vector<AddressProbe> ports(std::vector<AddressProbe> addresses) {
    return wait(&op::AddressProbes::try_ports, std::move(addresses));
  }
  Port port(const std::string& address) { return ports({to_try(address)}).front().port; }
  std::vector<AddressProbe> datagrams(std::vector<AddressProbe> addresses) {
    return wait(&op::AddressProbes::try_datagrams, std::move(addresses));
  }

  static AddressProbe to_try(const std::string& address) {
    AddressProbe out;
    out.address = address;
    return out;
  }

 private:
  using Begin = void (op::AddressProbes::*)(std::vector<AddressProbe>, op::AddressProbes::Done);
  std::vector<AddressProbe> wait(Begin begin, std::vector<AddressProbe> addresses) {
    std::optional<std::vector<AddressProbe>> out;
    (probes_.*begin)(std::move(addresses), [&out](std::vector<AddressProbe> seen) { out = std::move(seen); });
    while (!out) loop_.turn();
    return std::move(*out);
  }

  Loop& loop_;
  op::AddressProbes probes_;
};

/// The node's folder is the working directory by now.
void look_for_sockets(const NodeConfig& config, Observed& seen) {
  std::vector<std::string> names = config.services;
  names.insert(names.end(), {"probe", "tap"});
  for (const std::string& name : names) {
    const std::string path = "bus/" + name + ".ipc";
    if (config.bus.empty() && name != "router" && !file_exists(path)) seen.missing_sockets.push_back(path);
  }
}

/// The router's own ports: of its bus, if that is TCP, and for other routers.
void try_own_ports(const NodeConfig& config, AddressTests& tests, Observed& seen) {
  std::vector<AddressProbe> bus;
  if (const Endpoint at = split_endpoint(config.bus); !at.host.empty()) {
    for (const int further : {0, 1}) {
      bus.push_back(AddressTests::to_try(join_host_port(at.host, static_cast<std::uint16_t>(at.port + further))));
    }
  }
  for (const AddressProbe& probe : tests.ports(std::move(bus))) {
    if (probe.port != Port::zmtp) seen.missing_sockets.push_back("tcp://" + probe.address);
  }
  const Network& network = config.network;
  if (!network.address.empty())
    seen.inbox_open = tests.port(join_host_port(network.address, network.tcp_port_ext)) == Port::zmtp;
}

/// Lets the probe add what it has seen.
void observe(Probe& probe, Observed& seen, void (*add)(op::Session&, Observed, const op::ObservedNext&)) {
  seen = std::move(
      *probe.wait<Observed>([&](op::Session& session, const auto& done) { add(session, std::move(seen), done); }));
}

std::vector<AddressProbe> find_addresses(const NodeConfig& config, const Observed& seen) {
  std::vector<std::string> seeds;
  for (const Seed& seed : config.seeds) seeds.push_back(seed.address);
  return op::addresses_to_try(seen, seeds, op::in_own_subnet);
}

bool is_number(const AddressProbe& probe) {
  return is_numeric_endpoint(probe.address);
}

/// Only a way that carries something can carry too little.
bool carries_something(const AddressProbe& probe) {
  return probe.port == Port::zmtp && !probe.address.starts_with("127.");
}

/// Those of `probes` that `wanted` is true of, tried; the others stay as they are.
void try_some(std::vector<AddressProbe>& probes, bool (*wanted)(const AddressProbe&), AddressTests& tests,
              std::vector<AddressProbe> (AddressTests::*attempt)(std::vector<AddressProbe>)) {
  std::vector<AddressProbe> some;
  std::ranges::copy_if(probes, std::back_inserter(some), wanted);
  for (AddressProbe& tried : (tests.*attempt)(std::move(some))) {
    *std::ranges::find(probes, tried.address, &AddressProbe::address) = tried;
  }
}

void try_addresses(AddressTests& tests, Observed& seen) {
  std::stable_partition(seen.addresses.begin(), seen.addresses.end(), is_number);
  try_some(seen.addresses, is_number, tests, &AddressTests::ports);
  try_some(seen.addresses, carries_something, tests, &AddressTests::datagrams);
}

void try_robot(const NodeConfig& config, AddressTests& tests, Observed& seen) {
  if (config.mode != Mode::direct || config.robot.host.empty() || !config.commands.port) return;
  seen.robot.address = config.robot.host + ":" + std::to_string(*config.commands.port);
  const auto self = std::find_if(seen.routes.routes.begin(), seen.routes.routes.end(),
                                 [](const Route& route) { return route.state == "self"; });
  // A controller may take one connection only: it is tried when the node has none.
  if (self != seen.routes.routes.end() && self->profile.robot != "ONLINE")
    seen.robot.port = tests.port(seen.robot.address);
}

Value to_value(const Finding& finding) {
  return Value{Value::Object{{"severity", Value{finding.weight == Weight::problem ? "problem" : "note"}},
                             {"cause", Value{finding.cause}},
                             {"subject", Value{finding.subject}},
                             {"what", Value{finding.what}},
                             {"cure", Value{finding.hint}}}};
}

int report(const Arguments& arguments, const Observed& seen, const std::vector<Finding>& findings) {
  const bool well = std::none_of(findings.begin(), findings.end(),
                                 [](const Finding& finding) { return finding.weight == Weight::problem; });
  if (arguments.has("--json")) {
    Value::List list;
    for (const Finding& finding : findings) list.push_back(to_value(finding));
    print_json(
        Value{Value::Object{{"node", Value{seen.node}}, {"well", Value{well}}, {"findings", Value{std::move(list)}}}});
    return well ? kGood : kFailed;
  }
  for (const Finding& finding : findings) {
    const bool problem = finding.weight == Weight::problem;
    print_line(coloured(problem ? Colour::bad : Colour::plain, problem ? "problem" : "note   ") + "  " +
               finding.subject + ": " + finding.what + "  [" + finding.cause + "]");
    print_line("         -> " + finding.hint);
  }
  const auto online = std::count_if(seen.routes.routes.begin(), seen.routes.routes.end(),
                                    [](const Route& route) { return route.state == "ONLINE"; });
  if (well)
    print_line(coloured(Colour::good, "well     ") + seen.node + ": services up, linked with " +
               std::to_string(online) + (online == 1 ? " node" : " nodes") + ", no problem found");
  return well ? kGood : kFailed;
}

int run_doctor(const Arguments& arguments) {
  auto dir = find_node(arguments);
  if (!dir) return print_error(arguments, dir.error());
  if (::chdir(dir->c_str()) != 0)
    return print_error(arguments, fail(Errc::missing, *dir + ": no such folder", "name a node's folder"));
  Observed seen;
  NodeConfig config;
  seen.asked = arguments.words.empty() ? "" : arguments.words[0];
  look_at_folder(".", seen, config);
  progress(arguments, "asking the router of " + seen.node);
  auto probe = Probe::open(".");
  if (probe) observe(**probe, seen, op::observe_router);
  seen.bus_key_refused = !probe && probe.error().code == Errc::wrong_key;
  look_for_sockets(config, seen);
  Loop alone;  // without a router
  AddressTests tests(probe ? (*probe)->bus().loop() : alone);
  try_own_ports(config, tests, seen);
  seen.addresses = find_addresses(config, seen);
  progress(arguments, "trying " + std::to_string(seen.addresses.size()) + " addresses");
  try_addresses(tests, seen);
  if (probe) observe(**probe, seen, op::observe_links);
  try_robot(config, tests, seen);
  return report(arguments, seen, op::diagnose(seen));
}

const std::vector<Command> kCommands = {
    {{"doctor"},
     {"doctor [PEER]",
      "Looks at the node's files, services, links and robot, and names what is wrong and the cure. PEER is an id or\n"
      "HOST:PORT: looks at that one alone, also if it was never heard of. Exit status 0: no problem found.",
      {"--node DIR|the node to look at (else TRB_NODE, else this folder)", "--json|for programs"},
      {"trb doctor --node nodes/ur3", "trb doctor ridgeback", "trb doctor 10.0.2.7:45000 --json"},
      0,
      1},
     run_doctor},
};

}  // namespace

std::vector<Command> doctor_commands() {
  return kCommands;
}

}  // namespace trb::cli
