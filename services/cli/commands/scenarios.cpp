// scenario run, list, watch, abort, pause, resume.
#include <cstdio>
#include <set>

#include "common/base/hex.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/run_start.hpp"
#include "common/security/keys.hpp"
#include "common/transport/loop.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/runs.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

/// The run's robots, the own node, and every cloud node: those whose certificates the run needs.
Result<std::vector<Member>> members_of(const std::vector<std::string>& robots, const RouteTable& table) {
  std::set<std::string> wanted{table.node};
  wanted.insert(robots.begin(), robots.end());
  std::vector<Member> out;
  for (const Route& route : table.routes) {
    if (wanted.erase(route.id) != 0 || route.role == Role::cloud) out.push_back({route.id, route.certificate});
  }
  if (!wanted.empty())
    return fail(Errc::unknown_target, "node '" + *wanted.begin() + "' was never heard", "see trb route list");
  return out;
}

Result<std::string> submit(Probe& probe, Scenario scenario, std::vector<std::string> robots, const RouteTable& table,
                           double hours, std::uint32_t priority) {
  auto members = members_of(robots, table);
  if (!members) return members.error();
  const UtcTime utc = read_clocks().utc;
  const RunStart start =
      build_run_start(std::move(scenario), std::move(*members), probe.node(), utc, utc + seconds(hours * 3600),
                      to_hex(random_bytes(16)), std::move(robots), priority);
  auto record = probe.ask_node<SignedRecord>(SignRequest{std::string(kSignedRunStart), {encode(start)}});
  if (!record) return record.error();
  auto answer = probe.ask(Send{.type = MessageType::command, .target = probe.node(), .body = RunSubmit{*record}});
  if (!answer) return answer.error();
  auto accepted = decode<RunAccepted>(answer->data);
  if (!accepted) return accepted.error();
  return accepted->run;
}

bool is_over(RunState state) {
  return state == RunState::finished || state == RunState::aborted || state == RunState::expired;
}

std::string duration_text(const TaskView& task) {
  if (task.ended == 0 || task.state == TaskState::skipped) return "";
  char out[32];
  std::snprintf(out, sizeof out, "%.2f s", task.duration_s);
  return out;
}

std::string state_text(const TaskView& task) {
  const std::string name(name_of(task.state));
  if (task.state == TaskState::finished) return coloured(Colour::good, name);
  if (task.state == TaskState::failed || task.state == TaskState::retriable) return coloured(Colour::bad, name);
  const bool dim = task.state == TaskState::waiting || task.state == TaskState::skipped;
  return dim ? coloured(Colour::dim, name) : name;
}

/// Why it ended so; else, once it has ended, what its condition came to.
std::string why_text(const TaskView& task) {
  const std::string& why = task.reason.empty() && task.ended != 0 ? task.condition : task.reason;
  return why.empty() ? "" : " (" + why + ")";
}

void print_changes(const RunView& before, const RunView& after) {
  for (std::size_t i = 0; i < after.tasks.size(); ++i) {
    const TaskView& task = after.tasks[i];
    const TaskState was = i < before.tasks.size() ? before.tasks[i].state : TaskState::waiting;
    if (task.state == was) continue;
    const std::string place = std::to_string(i + 1) + "/" + std::to_string(after.tasks.size());
    print_line("  " + place + "  " + (task.robot.empty() ? "-" : task.robot) + " " + task.id + "  " + state_text(task) +
               " " + duration_text(task) + why_text(task));
  }
  if (after.waits_for != before.waits_for && !after.waits_for.empty()) print_line("  waits for: " + after.waits_for);
}

/// Mode and transport belong to the robot, not to the run: they are joined in from the routing table.
Value view_json(const RunView& view, const RouteTable& table) {
  const auto profiles = profiles_of(table);
  Value json = *parse_json(to_json(view));
  for (auto& [key, member] : std::get<Value::Object>(json.is)) {
    if (key != "tasks") continue;
    for (Value& task : std::get<Value::List>(member.is)) {
      const auto profile = profiles.find(task.find("robot")->text());
      if (profile == profiles.end()) continue;
      auto& fields = std::get<Value::Object>(task.is);
      fields.emplace_back("mode", Value{profile->second.mode});
      fields.emplace_back("transport", Value{profile->second.transport});
    }
  }
  std::vector<std::string> robots;
  for (const TaskView& task : view.tasks) robots.push_back(task.robot);
  const Blocks blocks = blocks_of(robots);
  auto& top = std::get<Value::Object>(json.is);
  top.emplace_back("blocks_k", Value{static_cast<std::int64_t>(blocks.k)});
  top.emplace_back("blocks_sum_m", Value{static_cast<std::int64_t>(blocks.sum_m)});
  return json;
}

int print_end(const Arguments& arguments, Probe& probe, const RunView& view) {
  if (arguments.has("--json")) {
    auto table = probe.ask_node<RouteTable>(RouteListRequest{});
    print_json(view_json(view, table ? *table : RouteTable{}));
  } else {
    const bool good = view.state == RunState::finished;
    print_line("run " + view.run.substr(0, 8) + " " +
               coloured(good ? Colour::good : Colour::bad, std::string(name_of(view.state))));
  }
  return view.state == RunState::finished ? kGood : kFailed;
}

int watch(const Arguments& arguments, Probe& probe, const std::string& run) {
  const auto wait = arguments.number("--timeout", 1e8);
  if (!wait) return print_error(arguments, wait.error());
  const MonotonicTime end = read_clocks().mono + seconds(*wait);
  RunView before;
  for (bool first = true;; first = false) {
    auto view = probe.ask_node<RunView>(RunQuery{run});
    if (!view && (first || read_clocks().mono >= end)) return print_error(arguments, view.error());
    if (view) {
      if (first && !arguments.has("--json")) print_line("run " + view->run.substr(0, 8) + " '" + view->name + "'");
      if (!arguments.has("--json")) print_changes(before, *view);
      before = std::move(*view);
      const bool stuck = arguments.has("--until-paused") && before.state == RunState::paused;
      if (is_over(before.state) || stuck || arguments.has("--once") || read_clocks().mono >= end)
        return print_end(arguments, probe, before);
    }
    probe.receive(std::chrono::milliseconds(150));
  }
}

Result<std::uint32_t> priority_of(const Arguments& arguments) {
  const std::string text = arguments.get("--priority", "0");
  if (text.size() == 1 && text[0] >= '0' && text[0] <= '9') return static_cast<std::uint32_t>(text[0] - '0');
  return fail(Errc::bad_value, "--priority: '" + text + "'", "use a whole number from 0 to 9");
}

int run_run(const Arguments& arguments) {
  ConfigFaults faults;
  const std::string& path = arguments.words[0];
  Scenario scenario = read_file_scenario(path, faults);
  if (!faults.empty()) return print_faults(arguments, faults);
  const auto hours = arguments.number("--expires-h", 24);
  if (!hours) return print_error(arguments, hours.error());
  const auto priority = priority_of(arguments);
  if (!priority) return print_error(arguments, priority.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto table = probe->ask_node<RouteTable>(RouteListRequest{});
  if (!table) return print_error(arguments, table.error());
  const Binder binder = find_binder(*probe, scenario, *table);
  std::vector<std::string> robots = robots_for(scenario, profiles_of(*table), binder, path, faults);
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults);
  const Value::List bound = bound_json(scenario, robots, binder);
  if (!arguments.has("--json")) print_bound(scenario, robots, binder, faults);
  auto run = submit(*probe, std::move(scenario), std::move(robots), *table, *hours, *priority);
  if (!run) return print_error(arguments, run.error());
  if (arguments.has("--watch")) return watch(arguments, *probe, *run);
  if (arguments.has("--json")) {
    Value::Object answer{{"run", Value{*run}}};
    if (!bound.empty()) answer.emplace_back("bound", Value{bound});
    print_json(Value{std::move(answer)});
  } else {
    print_line("run " + *run + " accepted; follow it with: trb scenario watch " + run->substr(0, 8));
  }
  return kGood;
}

int run_watch(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  return watch(arguments, *probe, arguments.words.empty() ? "" : arguments.words[0]);
}

int run_abort(const Arguments& arguments) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto view = probe->ask_node<RunView>(RunQuery{arguments.words[0]});
  if (!view) return print_error(arguments, view.error());
  const AbortOrder order{view->run, probe->node(), arguments.get("--reason", "trb scenario abort"),
                         read_clocks().utc.ns};
  auto record = probe->ask_node<SignedRecord>(SignRequest{std::string(kSignedRunAbort), {encode(order)}});
  if (!record) return print_error(arguments, record.error());
  auto answer = probe->ask(Send{.type = MessageType::command, .target = probe->node(), .body = RunAbort{*record}});
  if (!answer) return print_error(arguments, answer.error());
  const auto wait = arguments.number("--timeout", 5);
  if (!wait) return print_error(arguments, wait.error());
  const MonotonicTime end = read_clocks().mono + seconds(*wait);
  while (read_clocks().mono < end) {
    view = probe->ask_node<RunView>(RunQuery{order.run});
    if (view && view->state == RunState::aborted) break;
    probe->receive(std::chrono::milliseconds(100));
  }
  if (!view) return print_error(arguments, view.error());
  const bool done = view->state == RunState::aborted;
  if (arguments.has("--json")) {
    print_line(to_json(*view));
  } else {
    print_line("run " + view->run.substr(0, 8) + " " + std::string(name_of(view->state)) +
               (done ? ": every member has confirmed" : ": waits for " + view->waits_for));
  }
  return done ? kGood : kFailed;
}

int order_pause(const Arguments& arguments, bool paused) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto view = probe->ask_node<RunView>(RunQuery{arguments.words[0]});
  if (!view) return print_error(arguments, view.error());
  const std::string reason = arguments.get("--reason", paused ? "trb scenario pause" : "trb scenario resume");
  PauseOrder order{view->run, view->pause_number + 1, paused, probe->node(), reason, read_clocks().utc.ns, {}};
  // Who lets it go on has seen what was done twice.
  for (const TaskView& task : view->tasks) {
    if (!paused && task.twice) order.doubles.push_back(task.id);
  }
  auto record = probe->ask_node<SignedRecord>(SignRequest{std::string(kSignedRunPause), {encode(order)}});
  if (!record) return print_error(arguments, record.error());
  auto answer = probe->ask(Send{.type = MessageType::command, .target = probe->node(), .body = RunPause{*record}});
  if (!answer) return print_error(arguments, answer.error());
  view = probe->ask_node<RunView>(RunQuery{order.run});
  if (!view) return print_error(arguments, view.error());
  if (arguments.has("--json")) {
    print_line(to_json(*view));
  } else {
    print_line("run " + view->run.substr(0, 8) + " " + std::string(name_of(view->state)) +
               (view->waits_for.empty() ? "" : ": waits for " + view->waits_for));
  }
  return kGood;
}

int run_pause(const Arguments& arguments) {
  return order_pause(arguments, true);
}

int run_resume(const Arguments& arguments) {
  return order_pause(arguments, false);
}

const std::string kNode = "--node DIR|the node to ask (else TRB_NODE, else this folder)";
const std::string kJson = "--json|for programs";
const std::string kUntilPaused = "--until-paused|also end when the run waits for a person";

}  // namespace

std::vector<Command> scenario_commands() {
  return {
      {{"scenario", "check"},
       {"scenario check FILE",
        "Tells every fault of a scenario; with a node also unknown robots, skills, places, sensors and wrong "
        "parameters,\nand the preflight: the tasks that nobody else in the fleet could take over now.",
        {kNode, kJson},
        {"trb scenario check config/scenarios/paper-nine-tasks.json"},
        1,
        1},
       run_scenario_check},
      {{"scenario", "run"},
       {"scenario run FILE",
        "Checks, signs and submits a scenario. The run goes on without this command. The robot of a task that\n"
        "names none is chosen when the task is due, by the ranking of replacements; at once, the first by id that can, "
        "if\nno cloud node decides.",
        {"--watch|follow it to its end", kUntilPaused, "--expires-h H|nothing of it starts later than that (24)",
         "--priority N|of two runs that want a robot the higher one begins: 0 to 9 (0)",
         "--timeout S|stop following after S seconds", kNode, kJson},
        {"trb scenario run config/scenarios/paper-nine-tasks.json --watch"},
        1,
        1},
       run_run},
      {{"scenario", "list"},
       {"scenario list",
        "The runs that are not over on this node; trb run list --all has its archive, too.",
        {kNode, kJson},
        {"trb scenario list"},
        0,
        0},
       list_runs},
      {{"scenario", "watch"},
       {"scenario watch [RUN]",
        "Follows a run (the newest, or by the beginning of its id) to its end; exit 0 only if it FINISHED.",
        {"--once|show it as it is and end", kUntilPaused, "--timeout S|stop following after S seconds", kNode, kJson},
        {"trb scenario watch", "trb scenario watch 3f2a --once --json"},
        0,
        1},
       run_watch},
      {{"scenario", "abort"},
       {"scenario abort RUN",
        "Ends a run for good; waits until every member has confirmed.",
        {"--reason TEXT|for the record", "--timeout S|how long to wait (5)", kNode, kJson},
        {"trb scenario abort 3f2a --reason 'wrong box'"},
        1,
        1},
       run_abort},
      {{"scenario", "pause"},
       {"scenario pause RUN",
        "Holds a run: what runs is finished, nothing is begun, on every node that can be reached; the others when they "
        "come back. This stops no robot: trb stop does.",
        {"--reason TEXT|for the record", kNode, kJson},
        {"trb scenario pause 3f2a --reason 'the hall is being cleaned'"},
        1,
        1},
       run_pause},
      {{"scenario", "resume"},
       {"scenario resume RUN",
        "Lets a run go on that was held.",
        {"--reason TEXT|for the record", kNode, kJson},
        {"trb scenario resume 3f2a"},
        1,
        1},
       run_resume},
  };
}

}  // namespace trb::cli
