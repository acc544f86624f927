// robot history: what a node's trb-resilience has seen of the fleet's robots.
#include <cmath>

#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

Result<std::uint32_t> most_of(const Arguments& arguments) {
  const auto most = arguments.number("--most", 50);
  if (!most) return most.error();
  if (*most >= 1 && *most <= 500 && *most == std::floor(*most)) return static_cast<std::uint32_t>(*most);
  return fail(Errc::bad_value, "--most: '" + arguments.get("--most") + "'", "use a whole number from 1 to 500");
}

int run_history(const Arguments& arguments) {
  const auto most = most_of(arguments);
  if (!most) {
    print_error(arguments, most.error());
    return kWrongUse;
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const std::string robot = arguments.words.empty() ? "" : arguments.words[0];
  auto table = probe->ask_node<HistoryTable>(HistoryListRequest{robot, *most});
  if (!table) return print_error(arguments, table.error());
  if (arguments.has("--json")) {
    print_line(to_json(*table));
    return kGood;
  }
  if (table->events.empty()) {
    print_line("nothing has happened yet");
    return kGood;
  }
  std::vector<std::vector<std::string>> rows{{"TIME", "ROBOT", "WHAT", "TEXT"}};
  for (const RobotEvent& one : table->events) rows.push_back({to_iso8601({one.time}), one.robot, one.kind, one.text});
  print(format_table(rows));
  return kGood;
}

const std::vector<Command> kHistoryCommands = {
    {{"robot", "history"},
     {"robot history [ROBOT]",
      "What happened to the fleet's robots, newest first: who joined or went, lost its robot, was stopped, failed or "
      "was\n"
      "mended, as this node's trb-resilience saw it, which looks every few seconds: a retirement or a repair that was "
      "over\nbefore may be missing. 30 days and 10,000 events are kept.",
      {"--most N|so many events, 1 to 500 (50)", "--node DIR|the node to ask (else TRB_NODE, else this folder)", kJson},
      {"trb robot history", "trb robot history ridgeback --most 10", "trb robot history --json"},
      0,
      1},
     run_history},
};

}  // namespace

std::vector<Command> history_commands() {
  return kHistoryCommands;
}

}  // namespace trb::cli
