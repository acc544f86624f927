// up, down, check, reload.
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/base/files.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/registry.hpp"
#include "common/operator/doctor/service_findings.hpp"
#include "common/security/bus_keys.hpp"
#include "common/security/services.hpp"
#include "common/supervisor/node_lock.hpp"
#include "common/supervisor/process.hpp"
#include "common/supervisor/supervisor.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/node_logs.hpp"
#include "services/cli/core/wire.hpp"
#include "services/cli/io/folder_check.hpp"
#include "services/cli/io/gateway_check.hpp"
#include "services/cli/io/node_folder.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/ready.hpp"

namespace trb::cli {
namespace {

namespace fs = std::filesystem;
using supervisor::NodeLock;
using supervisor::ServiceProgram;

std::string absolute(const std::string& path) {
  return fs::weakly_canonical(fs::absolute(path)).string();
}

/// What is allowed, and mostly not meant.
std::vector<std::string> notes_of(const NodeConfig& config) {
  std::vector<std::string> notes;
  const std::string wire = note_of_wire(config.network.address, config.network.robot_address, config.robot.host);
  if (!wire.empty()) notes.push_back(wire);
  if (!config.framework.empty() && !config.has_service("mode-adapter"))
    notes.push_back(std::string(op::kNoModeAdapter) + "; " + std::string(op::kAddModeAdapter));
  return notes;
}

int run_check(const Arguments& arguments) {
  const std::string dir = absolute(arguments.words[0]);
  const auto holder = NodeLock::holder(dir);
  const bool running = holder || holder.error().code != Errc::missing;
  NodeCheck check = check_node_dir(dir, running, drivers::robot_transports());
  for (ConfigFault& fault : check_folder(dir)) check.faults.push_back(std::move(fault));
  if (check.config.has_service("cloud-gateway")) {
    for (ConfigFault& fault : check_gateway_certificate(dir)) check.faults.push_back(std::move(fault));
  }
  if (!check.faults.empty()) return print_faults(arguments, check.faults);
  const std::vector<std::string> notes = notes_of(check.config);
  const std::vector<std::string> unfinished = unfinished_folders(dir);
  if (arguments.has("--json")) {
    Value::Object json{{"faults", Value{Value::List{}}}};
    Value::List list;
    for (const std::string& note : notes) list.push_back(Value{note});
    for (const std::string& folder : unfinished) list.push_back(Value{note_of_unfinished(folder)});
    if (!list.empty()) json.emplace_back("notes", Value{std::move(list)});
    print_json(Value{std::move(json)});
  } else {
    print_line(arguments.words[0] + ": no faults" + (running ? " (the node is up: its ports were not tried)" : ""));
    for (const std::string& note : notes) print_line("note: node.json: " + note);
    for (const std::string& folder : unfinished) print_line("note: " + note_of_unfinished(folder));
  }
  return kGood;
}

/// Also for a node whose bus was sockets until now.
Status make_keys_of_bus(const NodeConfig& config) {
  return config.bus.empty() ? Status(Done{}) : make_bus_keys(config.dir, bus_names(config));
}

/// The services to start: those of node.json, but for one that is started elsewhere.
Result<std::vector<ServiceProgram>> services_to_start(const NodeConfig& config, const std::string& without) {
  std::vector<ServiceProgram> services;
  for (const std::string& name : config.services) {
    const auto own = config.own_services.find(name);
    const std::string shipped = supervisor::program_dir() + "/trb-" + name;
    if (name != without) services.push_back({name, own == config.own_services.end() ? shipped : own->second});
  }
  // One of the middleware's own that this node does not have is nobody's to start: one systemd unit serves every node.
  if (without.empty() || config.has_service(without) || is_reserved_service(without)) return services;
  return fail(Errc::bad_value, "--without " + without + ": node.json names no such service",
              "it may stay away as it is, or put it into \"services\" of node.json");
}

/// Said when the new files have faults.
const std::string kNotReloaded = "nothing was reloaded";

/// What a reload leads to; nothing: the files are not good, and all stays as it is.
std::optional<std::vector<ServiceProgram>> services_of_new_files(const Arguments& arguments, const std::string& dir) {
  const NodeCheck check = check_node_dir(dir, true, drivers::robot_transports());
  const bool stops = !faults_that_stop(check.faults).empty();
  if (!check.faults.empty()) print_faults(arguments, check.faults, stops ? kNotReloaded : "");
  if (Status made = make_keys_of_bus(check.config); !made) return std::nullopt;
  if (stops) return std::nullopt;
  const std::string without = arguments.get("--without");
  auto services = services_to_start(check.config, check.config.has_service(without) ? without : "");
  return services ? std::optional(std::move(*services)) : std::nullopt;
}

/// In the starting process, until the node is ready.
int detached(const Arguments& arguments, const std::string& dir, const std::string& id, pid_t supervisor,
             double wait_s) {
  if (supervisor < 0) return print_error(arguments, fail(Errc::io_error, "no process can be made", "free memory"));
  const auto ready = wait_ready(dir, supervisor, seconds(wait_s));
  if (!ready) return print_error(arguments, ready.error());
  if (arguments.has("--json")) {
    Value::Object json{{"node", Value{id}}, {"pid", Value{static_cast<std::int64_t>(supervisor)}}};
    Value::List notes;
    for (const std::string& note : *ready) notes.push_back(Value{note});
    if (!notes.empty()) json.emplace_back("notes", Value{std::move(notes)});
    print_json(Value{std::move(json)});
    return kGood;
  }
  const std::string pid = "(pid " + std::to_string(supervisor) + "); end it with trb down " + arguments.words[0];
  if (ready->empty()) print_line(id + ": ready " + pid);
  if (!ready->empty()) print_line(id + ": ready, but " + ready->front() + " " + pid);
  for (std::size_t more = 1; more < ready->size(); ++more) print_line(id + ": and " + (*ready)[more]);
  return kGood;
}

/// What trb up says of the node, a line each time; to log/up.log in words.
void say(const Arguments& arguments, const std::string& id, const std::string& text) {
  if (arguments.has("--json") && !arguments.has("--detach")) {
    print_json(Value{Value::Object{{"node", Value{id}}, {"text", Value{text}}}});
  } else {
    print_line(id + ": " + text);
  }
}

/// Until the node is ended.
int supervise(const Arguments& arguments, const std::string& dir, const std::string& id,
              const std::vector<ServiceProgram>& services) {
  supervisor::block_signals();  // before anybody finds this process by its lock: a reload would end it
  auto held = NodeLock::take(dir);
  if (!held) return print_error(arguments, held.error());
  supervisor::Supervisor supervisor(dir, services, [&](const std::string& text) { say(arguments, id, text); });
  if (arguments.has("--detach")) supervisor.each_round([&] { bound_log(dir); });
  const auto reload = [&] { return services_of_new_files(arguments, dir); };
  ReadyCheck is_ready(dir);
  const int status = supervisor.run(reload, [&] { return is_ready() ? std::string() : is_ready.waits_for(); });
  forget_lost_output();  // a full disk does not make the node's end a failure
  return status;
}

/// Who is 1 now is not who started this: that one has ended.
void end_with_starter() {
  const pid_t starter = ::getppid();
  supervisor::die_with_parent(starter == 1 ? 0 : starter);
}

int run_up(const Arguments& arguments) {
  if (arguments.has("--die-with-parent")) end_with_starter();
  const std::string dir = absolute(arguments.words[0]);
  // Before the check: a node that is up holds its ports, and that is not what is wrong.
  const auto pid = NodeLock::holder(dir);
  if (pid) {
    return print_error(arguments, fail(Errc::conflict, dir + " is up already (pid " + std::to_string(*pid) + ")",
                                       "stop that one first, or use trb reload"));
  }
  if (pid.error().code != Errc::missing) return print_error(arguments, pid.error());
  NodeCheck check = check_node_dir(dir, false, drivers::robot_transports());
  // Who starts the gateway has it up already, perhaps, and then its port is not free.
  if (arguments.get("--without") == "cloud-gateway") {
    std::erase_if(check.faults, [](const ConfigFault& one) { return one.file == "cloud.json" && one.key == "listen"; });
  }
  const ConfigFaults stopping = faults_that_stop(check.faults);
  if (!stopping.empty()) return print_faults(arguments, check.faults, "nothing was started");
  if (Status may = may_start(dir, check.config.bus.empty()); !may) return print_error(arguments, may.error());
  if (!check.faults.empty() && arguments.has("--json")) {
    print_json(faults_json(check.faults));
  } else if (!check.faults.empty()) {
    print(check.config.id + ": starts and waits: " + to_text(check.faults));
  }
  const auto services = services_to_start(check.config, arguments.get("--without"));
  if (!services) return print_error(arguments, services.error());
  if (Status made = make_keys_of_bus(check.config); !made) return print_error(arguments, made.error());
  const auto wait_s = arguments.number("--timeout", 30);
  if (!wait_s) return print_error(arguments, wait_s.error());
  const std::string id = check.config.id;
  if (arguments.has("--detach")) {
    if (const pid_t child = ::fork(); child != 0) return detached(arguments, dir, id, child, *wait_s);
    leave_terminal(dir);
  }
  return supervise(arguments, dir, id, *services);
}

/// What `trb up --without` of this process leaves to somebody else; empty: nothing, or it cannot be known.
std::string left_out_by(pid_t up) {
  std::ifstream words("/proc/" + std::to_string(up) + "/cmdline");
  const std::string option = "--without";
  for (std::string word; std::getline(words, word, '\0');) {
    if (word.starts_with(option + "=")) return word.substr(option.size() + 1);
    if (word == option && std::getline(words, word, '\0')) return word;
  }
  return "";
}

int run_reload(const Arguments& arguments) {
  const std::string dir = absolute(arguments.words[0]);
  const NodeCheck check = check_node_dir(dir, true, drivers::robot_transports());
  if (!faults_that_stop(check.faults).empty()) return print_faults(arguments, check.faults, kNotReloaded);
  auto pid = NodeLock::holder(dir);
  if (!pid) return print_error(arguments, pid.error());
  if (::kill(*pid, SIGHUP) != 0)
    return print_error(arguments, fail(Errc::io_error, "cannot signal pid " + std::to_string(*pid)));
  const std::string other = left_out_by(*pid);
  const bool has_other = check.config.has_service(other);
  if (arguments.has("--json")) {
    Value::Object json{{"node", Value{check.config.id}}};
    if (has_other) json.emplace_back("not_reached", Value{Value::List{Value{other}}});
    print_json(Value{std::move(json)});
    return kGood;
  }
  print_line(check.config.id + ": each service takes the new files once it is idle");
  if (has_other) {
    print_line(check.config.id + ": " + other +
               " is for whoever starts it to ask (with Debian's package: systemctl reload talkrobots)");
  }
  return kGood;
}

/// 0: it cannot be known.
pid_t parent_of(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  const std::string key = "PPid:";
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return static_cast<pid_t>(std::strtol(line.c_str() + key.size(), nullptr, 10));
  }
  return 0;
}

/// The folder of the demonstration that would start this node again at once; empty: none does.
std::string kept_up_by(const std::string& dir, pid_t node) {
  const std::string demo = fs::path(dir).parent_path().parent_path().string();
  if (!file_exists(demo + "/demo.json")) return "";
  const auto supervisor = NodeLock::holder(demo);
  return supervisor && parent_of(node) == *supervisor ? demo : "";
}

int run_down(const Arguments& arguments) {
  const std::string dir = absolute(arguments.words[0]);
  // A node's folder, or that of a demonstration.
  const Status there = find_node_json(dir, "name a node's folder, or that of trb demo");
  if (!there && !file_exists(dir + "/demo.json") && !file_exists(dir + "/state/up.lock"))
    return print_error(arguments, there.error());
  const auto pid = NodeLock::holder(dir);
  if (!pid && pid.error().code == Errc::missing && file_exists(dir + "/demo.json"))
    return print_error(arguments, fail(Errc::missing, pid.error().what, "start it: trb demo " + dir));
  if (!pid) return print_error(arguments, pid.error());
  const auto wait = arguments.number("--timeout", 10);
  if (!wait) return print_error(arguments, wait.error());
  if (const std::string demo = kept_up_by(dir, *pid); !demo.empty())
    return print_error(arguments, fail(Errc::conflict, "trb demo keeps " + dir + " up: it would be started again",
                                       "end the whole demonstration: trb down " + demo));
  if (::kill(*pid, SIGTERM) != 0 || !wait_down(dir, seconds(*wait))) {
    return print_error(arguments, fail(Errc::timeout, dir + " is still up (pid " + std::to_string(*pid) + ")",
                                       "are you its user? see " + dir + "/log"));
  }
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"dir", Value{arguments.words[0]}}, {"state", Value{"down"}}}});
  } else {
    print_line(arguments.words[0] + ": down");
  }
  return kGood;
}

const std::vector<Command> kNodeCommands = {
    {{"up"},
     {"up NODE_DIR",
      "Checks a node's folder, starts its services and keeps them running until Ctrl-C or SIGTERM.\nSays 'ID: ready' "
      "once all of them are up.",
      {"--without SERVICE|leave this one to somebody else, who starts it with its own rights",
       "--detach|return once it is ready and leave it up; its words go to NODE_DIR/log/up.log",
       "--timeout S|of --detach: how long to wait for that (30)",
       "--die-with-parent|end when the starting process ends, however it ends", kJson},
      {"trb up nodes/ur3", "trb up nodes/ur3 --detach", "trb up nodes/ur3 --without sensor-bus"},
      1,
      1},
     run_up},
    {{"down"},
     {"down NODE_DIR",
      "Ends a node's services, and returns once they have ended.",
      {"--timeout S|how long to wait for that (10)", kJson},
      {"trb down nodes/ur3"},
      1,
      1},
     run_down},
    {{"check"},
     {"check NODE_DIR",
      "Reads every file of a node's folder and tells every fault at once: file, key, cure. Starts nothing.",
      {kJson},
      {"trb check nodes/ur3", "trb check nodes/ur3 --json"},
      1,
      1},
     run_check},
    {{"reload"},
     {"reload NODE_DIR",
      "Checks the changed files; if they are good, each service takes them as soon as it is idle. One that was added "
      "to\n"
      "node.json is started, one that was taken out ends. Not the one of trb up --without: it is named, and whoever\n"
      "started it starts it again.",
      {kJson},
      {"trb reload nodes/ur3"},
      1,
      1},
     run_reload},
    {{"logs"},
     {"logs NODE_DIR [SERVICE]",
      "Shows the services' logs, newest last. SERVICE up: what trb up --detach has said.",
      {"--lines N|how many (50)", "--follow|go on with what comes", kJson},
      {"trb logs nodes/ur3 router --lines 200"},
      1,
      2},
     run_logs},
};

}  // namespace

std::vector<Command> node_commands() {
  return kNodeCommands;
}

}  // namespace trb::cli
