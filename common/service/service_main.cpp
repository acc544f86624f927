#include "common/service/service_main.hpp"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <variant>

#include "common/log/log.hpp"
#include "common/security/keys.hpp"

namespace trb {
namespace {

std::string usage_of(const ServiceProgram& program) {
  const std::string name = "trb-" + std::string(program.name);
  return name + " NODE_DIR\n\n" + std::string(program.purpose) +
         "\nUsually started by `trb up NODE_DIR`. Example: " + name + " " + std::string(program.example) + "\n";
}

/// The faults of the node's folder that prevent the start, or nothing.
std::string why_not(const NodeCheck& check, const ServiceProgram& program) {
  const bool lacks_interface = program.needs_robot_address && check.config.network.robot_address.empty();
  if (faults_that_stop(check.faults).empty() && !lacks_interface) return {};
  return "nothing started\n" + to_text(check.faults);
}

/// Why it did not run, or its exit status.
std::variant<std::string, int> run(const std::string& node_dir, const ServiceProgram& program) {
  init_crypto();
  static const Transports kNone;
  NodeCheck check = check_node_dir(node_dir, true, program.transports == nullptr ? kNone : program.transports());
  if (std::string why = why_not(check, program); !why.empty()) return why;
  const auto ended = program.run(std::move(check.config));
  if (!ended) return ended.error().text();
  return *ended;
}

/// The log of a node's folder that was up before; empty: there is none. Known before the service changes its folder.
std::string log_of(const std::string& node_dir, const ServiceProgram& program) {
  std::error_code none;
  const std::string logs = std::filesystem::absolute(node_dir, none).string() + "/log";
  return std::filesystem::is_directory(logs, none) ? logs + "/" + std::string(program.name) + ".log" : "";
}

}  // namespace

int service_main(int argc, char** argv, const ServiceProgram& program) {
  if (argc != 2 || std::string_view(argv[1]) == "--help") {
    std::fputs(usage_of(program).c_str(), stdout);
    return argc == 2 ? 0 : 2;
  }
  const std::string log = log_of(argv[1], program);
  std::string why;
  try {
    const auto ended = run(argv[1], program);
    if (const int* status = std::get_if<int>(&ended)) return *status;
    why = std::get<std::string>(ended);
  } catch (const std::exception& problem) {
    why = problem.what();
  }
  if (log.empty()) {
    std::fprintf(stderr, "trb-%s: %s\n", std::string(program.name).c_str(), why.c_str());
  } else {
    // Whoever started it may keep no words of it: trb logs must show why. The log says it on standard error, too.
    open_log(std::string(program.name), log);
    log_event(Level::error, "not_started", why);
  }
  return 1;
}

}  // namespace trb
