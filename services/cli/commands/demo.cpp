// demo: a small fleet with virtual robots in a folder, and all of it up.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/config/ports.hpp"
#include "common/security/authority.hpp"
#include "common/security/node_keys.hpp"
#include "common/supervisor/node_lock.hpp"
#include "common/supervisor/process.hpp"
#include "common/supervisor/supervisor.hpp"
#include "common/transport/loop.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/demo_fleet.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/ready.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;
using supervisor::NodeLock;
using supervisor::ServiceProgram;

constexpr auto kLook = std::chrono::milliseconds(100);
constexpr auto kYear = std::chrono::hours(24 * 365);

std::string node_dir(const std::string& dir, std::string_view id) {
  return dir + "/nodes/" + std::string(id);
}

/// The robots' nodes first: the cloud's is asked last, once all others are there.
std::vector<std::string> node_ids() {
  std::vector<std::string> ids;
  for (const DemoRobot& robot : demo_robots()) ids.emplace_back(robot.id);
  ids.emplace_back(kDemoCloud);
  return ids;
}

// ---- making it

/// The authority, on this computer and with its passphrase beside it, as no real fleet has it.
Status sign_all(const std::string& dir) {
  const std::string passphrase = to_hex(random_bytes(16));
  if (Status written = write_file(dir + "/passphrase", passphrase + "\n"); !written) return written;
  auto authority = make_authority(dir + "/authority", "demo", passphrase);
  if (!authority) return authority.error();
  for (const std::string& id : node_ids()) {
    const std::string keys = node_dir(dir, id) + "/keys";
    const auto text = read_file(keys + "/request.json");
    if (!text) return text.error();
    const auto request = from_json<SignedRecord>(*text);
    if (!request) return request.error();
    auto file = sign_request(*authority, dir + "/authority", *request, read_clocks().utc, kYear);
    if (!file) return file.error();
    if (Status written = write_file(keys + "/certificate.json", certificate_file_to_json(*file)); !written)
      return written;
  }
  return Done{};
}

Status make_fleet(const DemoFleet& fleet, const std::string& dir) {
  const auto config = config_dir();
  if (!config) return config.error();
  init_crypto();
  if (Status made = make_private_dir(dir); !made) return made;
  for (std::size_t i = 0; i < demo_robots().size(); ++i) {
    const NewNode node = node_of(fleet, i);
    if (Status made = make_node_folder(node, node_dir(dir, node.id), *config); !made) return made;
  }
  if (Status made = make_cloud_folder(cloud_of(fleet), node_dir(dir, kDemoCloud), *config); !made) return made;
  if (Status signed_all = sign_all(dir); !signed_all) return signed_all;
  if (Status written = write_file(dir + "/demo.json", demo_json(fleet)); !written) return written;
  return write_file(dir + "/first.json", demo_scenario());
}

Status make_folder(const DemoFleet& fleet, const std::string& dir) {
  return make_whole_folder(dir, [&](const std::string& making) { return make_fleet(fleet, making); });
}

// ---- running it

/// The virtual robots, and each node's own supervisor.
std::vector<ServiceProgram> programs_of(const DemoFleet& fleet, const std::string& dir) {
  const std::string programs = supervisor::program_dir();
  std::vector<ServiceProgram> out;
  for (std::size_t i = 0; i < demo_robots().size(); ++i) {
    const DemoRobot& robot = demo_robots()[i];
    out.push_back(
        {"virtual " + std::string(robot.id), programs + "/" + std::string(robot.program), robot_arguments(fleet, i)});
  }
  for (const std::string& id : node_ids())
    out.push_back({id, programs + "/trb", {"up", node_dir(dir, id), "--die-with-parent"}});
  return out;
}

Status check_programs(const std::vector<ServiceProgram>& programs, const DemoFleet& fleet) {
  const std::string gateway = supervisor::program_dir() + "/trb-cloud-gateway";
  if (fleet.page_port != 0 && !file_exists(gateway))
    return fail(Errc::missing, "--page: " + gateway + " is not there", "install the package talkrobots-cloud");
  for (const ServiceProgram& one : programs) {
    if (!file_exists(one.program))
      return fail(Errc::missing, one.program + " is not there", "install the package talkrobots-virtual-robots");
  }
  return Done{};
}

/// Every node's services are up, and the cloud knows every robot as connected.
class FleetReady {
 public:
  explicit FleetReady(const std::string& dir) : dir_(dir), left_(node_ids()) {}
  bool operator()() {
    while (!left_.empty()) {
      if (!check_ || checked_ != left_.front()) check_.emplace(node_dir(dir_, checked_ = left_.front()));
      if (!(*check_)()) return false;
      left_.erase(left_.begin());
    }
    return robots_are_there();
  }
  [[nodiscard]] std::string waits_for() const {
    return left_.empty() ? "its robots are not connected yet" : left_.front() + ": " + check_->waits_for();
  }

 private:
  bool robots_are_there() {
    if (!cloud_) {
      auto probe = Probe::open(node_dir(dir_, kDemoCloud));
      if (!probe) return false;
      cloud_ = std::move(*probe);
    }
    const auto table = cloud_->routes();
    const auto is_there = [](const Route& route) { return route.state == "ONLINE" && route.profile.robot == "ONLINE"; };
    return table && std::ranges::count_if(table->routes, is_there) == static_cast<long>(demo_robots().size());
  }

  std::string dir_;
  std::vector<std::string> left_;
  std::string checked_;
  std::optional<ReadyCheck> check_;
  std::unique_ptr<Probe> cloud_;
};

/// Each of the nodes has a supervisor of its own, which kills what does not end in 3 s, and then waits for that: killed
/// before, it would leave it running.
constexpr Duration kNodesGrace = std::chrono::seconds(7);

/// In the child, until it is ended.
int supervise(const DemoFleet& fleet, const std::string& dir) {
  leave_terminal(dir);
  auto held = NodeLock::take(dir);
  if (!held) return kFailed;
  supervisor::block_signals();
  supervisor::Supervisor supervisor(
      dir, programs_of(fleet, dir), [](const std::string& text) { print_line(text); }, kNodesGrace);
  supervisor.each_round([&] { bound_log(dir); });
  const int status = supervisor.run([] { return std::nullopt; }, [] { return std::string(); });
  forget_lost_output();
  return status;
}

Status wait_fleet(const std::string& dir, pid_t child, Duration wait) {
  const MonotonicTime end = read_clocks().mono + wait;
  FleetReady ready(dir);
  while (!ready()) {
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child)
      return fail(Errc::conflict, dir + ": its supervisor has ended", "see " + dir + "/log/up.log");
    if (read_clocks().mono >= end) {
      return fail(Errc::timeout, dir + " is not ready: " + ready.waits_for() + "; it goes on trying",
                  "see " + dir + "/log/up.log; end it with trb down " + dir);
    }
    std::this_thread::sleep_for(kLook);
  }
  return Done{};
}

void print_next(const std::string& named, unsigned page_port) {
  const std::string cloud = " --node " + named + "/nodes/cloud";
  print_line(named + " is up: the nodes cloud, rover (a virtual Pioneer) and arm (a virtual UR3). next:");
  print_line("  trb scenario run " + named + "/first.json --watch" + cloud);
  print_line("  trb robot list" + cloud);
  if (page_port != 0)
    print_line("  trb cloud password " + named + "/nodes/cloud, then https://localhost:" + std::to_string(page_port) +
               "/");
  print_line("  trb down " + named);
}

bool is_made(const std::string& dir) {
  return file_exists(dir + "/demo.json");
}

/// The one that was made in this folder, else the one that the options say.
Result<DemoFleet> wanted_fleet(const Arguments& arguments, const std::string& dir) {
  if (is_made(dir)) {
    for (const char* option : {"--network", "--page", "--speed"}) {
      if (arguments.has(option))
        return fail(Errc::conflict, std::string(option) + ": " + dir + " was made before", "name a new folder");
    }
    const auto text = read_file(dir + "/demo.json");
    return text ? demo_fleet_of(*text) : Result<DemoFleet>(text.error());
  }
  const auto page = arguments.has("--page") ? arguments.number("--page", 0) : Result<double>(0.0);
  const auto speed = arguments.number("--speed", 1);
  if (!page || !speed) return (page ? speed : page).error();
  return demo_fleet(arguments.get("--network", "127.0.42"), *page, *speed);
}

/// Tried before anything is made: its nodes would wait for their ports in silence. Errors: conflict.
Status check_ports(const DemoFleet& fleet, const std::string& dir) {
  const auto is_taken = [](const std::string& address, std::uint16_t port) {
    const Status free = check_tcp_port(address, port);
    return !free && free.error().code == Errc::conflict;
  };
  const auto what = [](const std::string& address, unsigned port) {
    return address + ":" + std::to_string(port) + " is in use";
  };
  const std::string again = is_made(dir) ? "end the other one with trb down, or make a new folder with " : "";
  for (const DemoPort& one : demo_ports(fleet)) {
    if (is_taken(one.address, one.port))
      return fail(Errc::conflict, what(one.address, one.port) + ", as by another demonstration",
                  again + "--network " + next_network(fleet) + (again.empty() ? " has other addresses" : ""));
  }
  if (fleet.page_port == 0 || !is_taken("127.0.0.1", static_cast<std::uint16_t>(fleet.page_port))) return Done{};
  return fail(Errc::conflict, "--page: " + what("127.0.0.1", fleet.page_port),
              again + "--page " + std::to_string(fleet.page_port == 65535 ? 65534 : fleet.page_port + 1) +
                  (again.empty() ? " is another port" : ""));
}

int run_demo(const Arguments& arguments) {
  const std::string dir = fs::weakly_canonical(fs::absolute(arguments.words[0])).string();
  const auto pid = NodeLock::holder(dir);
  if (pid) {
    return print_error(arguments, fail(Errc::conflict, dir + " is up already (pid " + std::to_string(*pid) + ")",
                                       "end it with trb down " + dir));
  }
  if (pid.error().code != Errc::missing) return print_error(arguments, pid.error());
  const auto wait_s = arguments.number("--timeout", 60);
  if (!wait_s) return print_error(arguments, wait_s.error());
  const auto fleet = wanted_fleet(arguments, dir);
  if (!fleet) return print_error(arguments, fleet.error());
  if (Status good = check_programs(programs_of(*fleet, dir), *fleet); !good)
    return print_error(arguments, good.error());
  if (Status free = check_ports(*fleet, dir); !free) return print_error(arguments, free.error());
  if (Status made = is_made(dir) ? Status(Done{}) : make_folder(*fleet, dir); !made)
    return print_error(arguments, made.error());
  const pid_t child = ::fork();
  if (child == 0) return supervise(*fleet, dir);
  if (child < 0) return print_error(arguments, fail(Errc::io_error, "no process can be made", "free memory"));
  if (Status ready = wait_fleet(dir, child, seconds(*wait_s)); !ready) return print_error(arguments, ready.error());
  print_next(arguments.words[0], fleet->page_port);
  return kGood;
}

}  // namespace

std::vector<Command> demo_commands() {
  return {{{"demo"},
           {"demo DIR",
            "Makes a fleet of a cloud node and two virtual robots of two makers in a new folder, and starts it: this "
            "computer is\nenough. Returns once all are there. trb down DIR ends it, trb demo DIR starts it again.",
            {"--network N.N.N|the beginning of its addresses on this computer (127.0.42)",
             "--page PORT|the cloud's page, too, at https://localhost:PORT; then trb cloud password DIR/nodes/cloud",
             "--speed N|how much faster than real ones the robots move (1)",
             "--timeout S|how long to wait until all are there (60)", "--json|errors for programs"},
            {"trb demo hall", "trb demo hall --page 8443"},
            1,
            1},
           run_demo}};
}

}  // namespace trb::cli
