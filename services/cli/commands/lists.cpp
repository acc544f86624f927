// robot list, route list, service list, service counters.
#include <cstdio>

#include "common/base/ids.hpp"
#include "common/base/printable.hpp"
#include "common/operator/phases.hpp"
#include "common/operator/routes.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

std::string join(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ",") + word;
  return out.empty() ? "-" : out;
}

std::string short_seconds(double s) {
  char out[32];
  std::snprintf(out, sizeof out, "%.1f s", s);
  return out;
}

Result<RouteTable> ask_routes(Probe& probe) {
  return probe.routes();
}
Result<ServiceTable> ask_services(Probe& probe) {
  return probe.ask_node<ServiceTable>(ServiceListRequest{});
}

/// Asks, prints as JSON if wanted, else as the table that `rows` makes, with what `below` makes of it under it.
template <class Answer, class Rows, class Below = std::string (*)(const Answer&)>
int show(
    const Arguments& arguments, Result<Answer> (*ask)(Probe&), Rows rows,
    Below below = [](const Answer&) { return std::string(); }) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto answer = ask(*probe);
  if (!answer) return print_error(arguments, answer.error());
  if (arguments.has("--json")) {
    print_line(to_json(*answer));
  } else {
    print(format_table(rows(*answer)) + below(*answer));
  }
  return kGood;
}

/// "carry", "all", "retired".
std::string out_of_use_text(const NodeProfile& profile) {
  std::vector<std::string> words;
  for (const OutOfUse& one : profile.out_of_use) {
    words.push_back(one.retired ? "retired" : one.capability.empty() ? "all" : one.capability);
  }
  return join(words);
}

/// A line each: since when, why, and what ends it.
std::string out_of_use_lines(const RouteTable& table) {
  std::string out;
  for (const Route& route : table.routes) {
    for (const OutOfUse& one : route.profile.out_of_use) {
      const std::string what = one.capability.empty() ? "" : one.capability + " ";
      const std::string line =
          route.id + ": " +
          (one.retired ? "retired by " + one.by : what + "out of use, " + std::string(name_of(one.severity))) +
          " since " + to_iso8601({one.since}) + ": " + one.text + "; trb robot " +
          (one.retired ? "return " : "repaired ") + route.id;
      out += in_one_line(line) + "\n";
    }
  }
  return out;
}

int run_robots(const Arguments& arguments) {
  return show<RouteTable>(
      arguments, ask_routes,
      [](const RouteTable& table) {
        std::vector<std::vector<std::string>> rows{{"ROBOT", "NODE", "ROBOT IS", "FENCED", "OUT OF USE", "CONTROL",
                                                    "MODE", "TRANSPORT", "MODEL", "CAPABILITIES"}};
        for (const Route& route : table.routes) {
          if (route.role != Role::robot) continue;
          const NodeProfile& p = route.profile;
          // What a node has told last says nothing of its robot once the node is not reached.
          const bool reached = op::is_reached(route);
          const std::string robot = p.robot + (p.detail.empty() ? "" : " (" + p.detail + ")");
          rows.push_back({route.id, route.state == "self" ? "ONLINE" : route.state, reached ? or_dash(robot) : "-",
                          p.fenced ? "yes" : "no", out_of_use_text(p), reached ? or_dash(p.control) : "-",
                          or_dash(p.mode), or_dash(p.transport), or_dash(p.maker + " " + p.model),
                          join(p.capabilities)});
        }
        return rows;
      },
      out_of_use_lines);
}

int run_routes(const Arguments& arguments) {
  return show<RouteTable>(arguments, ask_routes, [](const RouteTable& table) {
    std::vector<std::vector<std::string>> rows{{"NODE", "ROLE", "ADDRESS", "STATE", "HEARD", "DIALLED BY", "BOOT",
                                                "VERSION", "CLOCK", "SENSORS", "CAPABILITIES"}};
    for (const Route& route : table.routes) {
      const std::string& dialled = route.dialled_by;
      rows.push_back({route.id, std::string(name_of(route.role)), route.address, route.state,
                      route.state == "self" ? "-" : short_seconds(route.last_heard_s),
                      or_dash(route.via.empty() ? dialled : "via " + route.via), std::to_string(route.boot),
                      or_dash(route.version), route.clock, join(route.profile.sensors),
                      join(route.profile.capabilities)});
    }
    return rows;
  });
}

/// The first few words and how many more: `--json` has them all.
std::string some_of(const std::vector<std::string>& words) {
  constexpr std::size_t kShown = 4;
  if (words.size() <= kShown + 1) return join(words);
  return join({words.begin(), words.begin() + kShown}) + " and " + std::to_string(words.size() - kShown) + " more";
}

int run_services(const Arguments& arguments) {
  return show<ServiceTable>(arguments, ask_services, [](const ServiceTable& table) {
    std::vector<std::vector<std::string>> rows{{"SERVICE", "STATE", "PID", "UP", "HEARD", "TAKES", "NOTE"}};
    for (const ServiceEntry& entry : table.services) {
      rows.push_back({entry.service, entry.state, entry.pid == 0 ? "-" : std::to_string(entry.pid),
                      short_seconds(entry.up_s), short_seconds(entry.last_heard_s), some_of(entry.subtypes),
                      or_dash(entry.note)});
    }
    return rows;
  });
}

std::vector<std::vector<std::string>> counter_rows(const Counters& counters) {
  std::vector<std::vector<std::string>> rows{{"COUNTER", "VALUE"}};
  for (const Counter& counter : counters.values) rows.push_back({counter.name, std::to_string(counter.value)});
  return rows;
}

/// The counters as JSON, and beside them the sums by phase of Equation 12.
Value counters_json(const Counters& counters) {
  Value json = *parse_json(to_json(counters));
  Value::List phases;
  for (const auto& [phase, value] : op::count_phases(counters)) {
    phases.push_back(Value{Value::Object{{"phase", Value{std::string(name_of(phase))}},
                                         {"value", Value{static_cast<std::int64_t>(value)}}}});
  }
  std::get<Value::Object>(json.is).emplace_back("phases", Value{std::move(phases)});
  return json;
}

int run_counters(const Arguments& arguments) {
  const std::string& service = arguments.words[0];
  if (const Status name = check_id("SERVICE", service); !name) return print_error(arguments, name.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  // A router of an earlier version knows only its own request.
  const auto counters = service == "router" ? probe->ask_node<Counters>(RouterCountersRequest{})
                                            : probe->ask_node<Counters>(ServiceCountersRequest{service});
  if (!counters) return print_error(arguments, counters.error());
  if (arguments.has("--json")) {
    print_json(counters_json(*counters));
  } else {
    print(format_table(counter_rows(*counters)));
  }
  return kGood;
}

const std::vector<Command> kListCommands = {
    {{"robot", "list"},
     {"robot list",
      "The fleet's robots: are they there, can they be commanded, what can they do?",
      {kAskedNode, kJson},
      {"trb robot list"},
      0,
      0},
     run_robots},
    {{"route", "list"},
     {"route list",
      "The node's routing table: every node of the fleet that it has heard of.",
      {kAskedNode, kJson},
      {"trb route list --json"},
      0,
      0},
     run_routes},
    {{"service", "list"},
     {"service list",
      "The node's services: which run, since when, what they take.",
      {kAskedNode, kJson},
      {"trb service list --node nodes/ur3"},
      0,
      0},
     run_services},
    {{"service", "counters"},
     {"service counters SERVICE",
      "What a service has counted since its start: messages, refusals, what should never be.",
      {kAskedNode, kJson},
      {"trb service counters router", "trb service counters scheduler --json"},
      1,
      1},
     run_counters},
};

}  // namespace

std::vector<Command> list_commands() {
  return kListCommands;
}

}  // namespace trb::cli
