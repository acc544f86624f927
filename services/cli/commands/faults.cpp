// robot fault: lets a virtual robot fail.
#include <algorithm>

#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

Result<InjectFault> order_of(const Arguments& arguments) {
  InjectFault order;
  if ((arguments.words.size() == 2) == arguments.has("--clear")) {
    return fail(Errc::missing, "which capability?", "name one, or give --clear: trb robot fault ROBOT CAPABILITY");
  }
  if (arguments.has("--clear")) return order;
  order.capability = arguments.words[1];
  if (order.capability.empty()) return fail(Errc::bad_value, "CAPABILITY: is empty", "trb robot list names them");
  const std::string severity = arguments.get("--severity", std::string(name_of(Severity::critical)));
  constexpr auto kNames = enum_names(Severity{});
  const auto* const named = std::find(kNames.begin(), kNames.end(), severity);
  if (named == kNames.end()) {
    return fail(Errc::bad_value, "--severity: '" + severity + "'", "use WARNING, URGENT, CRITICAL or FATAL");
  }
  order.severity = static_cast<Severity>(named - kNames.begin());
  order.text = arguments.get("--text");
  return order;
}

int run_fault(const Arguments& arguments) {
  const auto order = order_of(arguments);
  if (!order) {
    print_error(arguments, order.error());
    return kWrongUse;
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const std::string& robot = arguments.words[0];
  auto answer = probe->command(robot, *order);
  if (!answer) return print_error(arguments, answer.error());
  if (arguments.has("--json")) {
    print_line(message_to_json(*answer));
  } else if (arguments.has("--clear")) {
    print_line(robot + ": its injected faults are cleared");
  } else {
    print_line(robot + ": ordered to fail; `trb tap --subtype robot_fault` shows what the fleet is notified of");
  }
  return kGood;
}

const std::vector<Command> kFaultCommands = {
    {{"robot", "fault"},
     {"robot fault ROBOT [CAPABILITY]",
      "Lets a virtual robot fail as its maker's robot would, or ends that; a real robot refuses it.\n"
      "The virtual robot needs --control, and its node.json \"robot\": {\"fault_injection\": \"HOST:PORT\"}.",
      {"--severity S|WARNING, URGENT, CRITICAL or FATAL (CRITICAL)", "--text T|what the robot says of it",
       "--clear|the fault is over", "--node DIR|the node to send from (else TRB_NODE, else this folder)", kJson},
      {"trb robot fault ridgeback mobile", "trb robot fault ur3 grab --severity FATAL --text 'gripper jammed'",
       "trb robot fault ur3 --clear"},
      1,
      2},
     run_fault},
};

}  // namespace

std::vector<Command> fault_commands() {
  return kFaultCommands;
}

}  // namespace trb::cli
