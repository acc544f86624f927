// robot retire, return, repaired: a person's word whether a robot may be used.
#include "services/cli/commands/command.hpp"
#include "services/cli/io/person.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMaxReason = 255;

int order(const Arguments& arguments, Body order, const std::string& done) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const std::string& robot = arguments.words[0];
  auto answer = probe->command(robot, std::move(order));
  if (!answer) return print_error(arguments, probe->with_nearest(answer.error(), robot));
  print_line(arguments.has("--json") ? message_to_json(*answer) : robot + ": " + done);
  return kGood;
}

int run_retire(const Arguments& arguments) {
  const std::string reason = arguments.get("--reason");
  if (reason.empty() || reason.size() > kMaxReason) {
    print_error(arguments, fail(Errc::missing, "--reason: " + std::string(reason.empty() ? "why?" : "is too long"),
                                "say it in 255 bytes: --reason 'new wheels are coming'"));
    return kWrongUse;
  }
  return order(arguments, TakeOutOfUse{{"", {}, reason, 0, true, person_of(arguments)}},
               "is given no task any more; what it is at it finishes; trb robot return brings it back");
}

int run_return(const Arguments& arguments) {
  return order(arguments, TakeIntoUse{"", true, person_of(arguments)}, "is given tasks again");
}

int run_repaired(const Arguments& arguments) {
  const std::string capability = arguments.get("--capability");
  return order(arguments, TakeIntoUse{capability, false, person_of(arguments)},
               (capability.empty() ? "" : capability + " ") + std::string("is in use again"));
}

const std::string kPerson = "--person NAME|who says so ($USER)";
const std::string kUseNode =
    "--node DIR|the node to send from: the robot's or the cloud's (else TRB_NODE, else this folder)";

const std::vector<Command> kRobotUseCommands = {
    {{"robot", "retire"},
     {"robot retire ROBOT",
      "Takes a robot out of service: it finishes what it is at and is given no task until trb robot return.\n"
      "This stops nothing: trb stop does. Your own commands (trb send) still go.",
      {"--reason TEXT|why, for everybody who looks", kPerson, kUseNode, kJson},
      {"trb robot retire pioneer2 --reason 'new wheels are coming'"},
      1,
      1},
     run_retire},
    {{"robot", "return"},
     {"robot return ROBOT",
      "Brings a retired robot back.",
      {kPerson, kUseNode, kJson},
      {"trb robot return pioneer2"},
      1,
      1},
     run_return},
    {{"robot", "repaired"},
     {"robot repaired ROBOT",
      "Says that what a CRITICAL or FATAL fault took is whole again; trb robot list shows what is out of use.\n"
      "Needed where the robot cannot tell it itself; refused while the robot still tells the fault.",
      {"--capability C|that one alone; else every one", kPerson, kUseNode, kJson},
      {"trb robot repaired ridgeback", "trb robot repaired ridgeback --capability carry"},
      1,
      1},
     run_repaired},
};

}  // namespace

std::vector<Command> robot_use_commands() {
  return kRobotUseCommands;
}

}  // namespace trb::cli
