// scenario run, list, watch, abort, pause, resume.
#include <cstdio>

#include "common/operator/abort_run.hpp"
#include "common/operator/follow_run.hpp"
#include "common/operator/pause_run.hpp"
#include "common/operator/run_report.hpp"
#include "common/operator/submit_run.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/runs.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/core/task_words.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

std::string duration_text(const TaskView& task) {
  if (task.ended == 0 || task.state == TaskState::skipped) return "";
  char out[32];
  std::snprintf(out, sizeof out, "%.2f s", task.duration_s);
  return out;
}

std::string state_text(const TaskView& task) {
  const std::string name = state_word(task);
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

int print_end(const Arguments& arguments, Probe& probe, const RunView& view) {
  if (arguments.has("--json")) {
    const auto table = probe.routes();
    print_json(op::run_report(view, table ? *table : RouteTable{}));
  } else {
    const bool good = view.state == RunState::finished;
    print_line("run " + view.run.substr(0, 8) + " " +
               coloured(good ? Colour::good : Colour::bad, std::string(name_of(view.state))));
  }
  return view.state == RunState::finished ? kGood : kFailed;
}

/// How a run is followed; which one stands in no option. Errors: bad_value.
Result<op::FollowWish> follow_wish(const Arguments& arguments) {
  const auto wait = arguments.number("--timeout", 1e8);
  if (!wait) return wait.error();
  return op::FollowWish{"", seconds(*wait), arguments.has("--until-paused"), arguments.has("--once")};
}

int watch(const Arguments& arguments, Probe& probe, const op::FollowWish& wish) {
  const auto seen = [quiet = arguments.has("--json")](const RunView& before, const RunView& view) {
    if (quiet) return true;
    if (before.run.empty()) print_line("run " + view.run.substr(0, 8) + " '" + view.name + "'");
    print_changes(before, view);
    return true;
  };
  const auto view =
      probe.wait<RunView>([&](op::Session& session, const auto& done) { op::follow_run(session, wish, seen, done); });
  return view ? print_end(arguments, probe, *view) : print_error(arguments, view.error());
}

Result<std::uint32_t> priority_of(const Arguments& arguments) {
  const std::string text = arguments.get("--priority", "0");
  if (text.size() == 1 && text[0] >= '0' && text[0] <= '9') return static_cast<std::uint32_t>(text[0] - '0');
  return fail(Errc::bad_value, "--priority: '" + text + "'", "use a whole number from 0 to 9");
}

Result<op::RunTerms> terms_of(const Arguments& arguments) {
  constexpr double kMostHours = 366 * 24;  // as check_run_start
  const auto hours = arguments.number("--expires-h", 24, kMostHours);
  if (!hours) return hours.error();
  const auto priority = priority_of(arguments);
  if (!priority) return priority.error();
  return op::RunTerms{*hours, *priority};
}

/// [{"task", "robot"}] of the tasks without a robot; {"task", "by"} if it is chosen later.
Value::List bound_json(const std::vector<op::BoundTask>& bound) {
  Value::List out;
  for (const op::BoundTask& one : bound) {
    out.push_back(Value{Value::Object{{"task", Value{one.task}}, {one.later ? "by" : "robot", Value{one.node}}}});
  }
  return out;
}

/// What may wait (a sensor that is plugged in later) to standard error, and what becomes of tasks without a robot.
void print_bound(const op::RunPlan& plan, const std::vector<op::BoundTask>& bound) {
  print_problem(to_text(plan.faults));
  if (!plan.binder.why_not.empty()) {
    print_line("robots are chosen now, the first by id that can: " + plan.binder.why_not);
  }
  for (const op::BoundTask& one : bound) {
    print_line("task " + one.task +
               (one.later ? ": " + one.node + " chooses its robot when it is due" : " is given to " + one.node));
  }
}

/// `warnings`: what may wait, as print_bound() prints it.
int print_accepted(const Arguments& arguments, const std::string& run, const std::vector<op::BoundTask>& bound,
                   const ConfigFaults& warnings) {
  if (arguments.has("--json")) {
    Value::Object answer{{"run", Value{run}}};
    if (!warnings.empty()) answer.emplace_back("warnings", fault_list(warnings));
    if (!bound.empty()) answer.emplace_back("bound", Value{bound_json(bound)});
    print_json(Value{std::move(answer)});
  } else {
    print_line("run " + run + " accepted; follow it with: trb scenario watch " + run.substr(0, 8));
  }
  return kGood;
}

int run_run(const Arguments& arguments) {
  const std::string nothing = "nothing was started";
  ConfigFaults faults;
  const std::string& path = arguments.words[0];
  const Scenario scenario = read_file_scenario(path, faults);
  if (!faults.empty()) return print_faults(arguments, faults, nothing);
  const auto terms = terms_of(arguments);
  if (!terms) return print_error(arguments, terms.error());
  auto wish = follow_wish(arguments);  // before anything is signed: an error afterwards reads as if no run were begun
  if (!wish) return print_error(arguments, wish.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto plan = probe->wait<op::RunPlan>(
      [&](op::Session& session, const auto& done) { op::plan_run(session, scenario, path, done); });
  if (!plan) return print_error(arguments, plan.error());
  if (!faults_that_stop(plan->faults).empty()) return print_faults(arguments, plan->faults, nothing);
  const auto bound = op::bound_tasks(*plan);
  const ConfigFaults warnings = plan->faults;
  if (!arguments.has("--json")) print_bound(*plan, bound);
  const auto run = probe->wait<std::string>(
      [&](op::Session& session, const auto& done) { op::submit_run(session, std::move(*plan), *terms, done); });
  if (!run) return print_error(arguments, run.error());
  if (!arguments.has("--watch")) return print_accepted(arguments, *run, bound, warnings);
  wish->run = *run;
  return watch(arguments, *probe, *wish);
}

int run_watch(const Arguments& arguments) {
  auto wish = follow_wish(arguments);
  if (!wish) return print_error(arguments, wish.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  if (!arguments.words.empty()) wish->run = arguments.words[0];
  return watch(arguments, *probe, *wish);
}

/// The run as it is after an order: its state, and why it is not what was ordered.
void print_state(const Arguments& arguments, const RunView& view, const std::string& why) {
  if (arguments.has("--json")) return print_line(to_json(view));
  print_line("run " + view.run.substr(0, 8) + " " + std::string(name_of(view.state)) + why);
}

int run_abort(const Arguments& arguments) {
  const auto wait = arguments.number("--timeout", 5);
  if (!wait) return print_error(arguments, wait.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const op::AbortWish wish{arguments.words[0], arguments.get("--reason", "trb scenario abort"), seconds(*wait)};
  const auto view =
      probe->wait<RunView>([&](op::Session& session, const auto& done) { op::abort_run(session, wish, done); });
  if (!view) return print_error(arguments, view.error());
  const bool done = view->state == RunState::aborted;
  print_state(arguments, *view,
              done ? ": every member that is not revoked has confirmed" : ": waits for " + view->waits_for);
  return done ? kGood : kFailed;
}

/// op::pause_run or op::resume_run.
using Hold = void (*)(op::Session&, const std::string& run, const std::string& reason, const op::Callback<RunView>&);

int run_hold(const Arguments& arguments, Hold hold, const std::string& reason) {
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto view = probe->wait<RunView>([&](op::Session& session, const auto& done) {
    hold(session, arguments.words[0], arguments.get("--reason", reason), done);
  });
  if (!view) return print_error(arguments, view.error());
  print_state(arguments, *view, view->waits_for.empty() ? "" : ": waits for " + view->waits_for);
  return kGood;
}

int run_pause(const Arguments& arguments) {
  return run_hold(arguments, op::pause_run, "trb scenario pause");
}

int run_resume(const Arguments& arguments) {
  return run_hold(arguments, op::resume_run, "trb scenario resume");
}

const std::string kUntilPaused = "--until-paused|also end when the run waits for a person";

const std::vector<Command> kScenarioCommands = {
    {{"scenario", "check"},
     {"scenario check FILE",
      "Tells every fault of a scenario; with a node also unknown robots, skills, places, sensors and wrong "
      "parameters,\nand the preflight: the tasks that nobody else in the fleet could take over now.",
      {kAskedNode, kJson},
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
       "--timeout S|stop following after S seconds", kAskedNode, kJson},
      {"trb scenario run config/scenarios/paper-nine-tasks.json --watch"},
      1,
      1},
     run_run},
    {{"scenario", "list"},
     {"scenario list",
      "The runs that are not over on this node; trb run list --all has its archive, too.",
      {kAskedNode, kJson},
      {"trb scenario list"},
      0,
      0},
     list_runs},
    {{"scenario", "watch"},
     {"scenario watch [RUN]",
      "Follows a run (the newest, or by the beginning of its id) to its end; exit 0 only if it FINISHED.",
      {"--once|show it as it is and end", kUntilPaused, "--timeout S|stop following after S seconds", kAskedNode,
       kJson},
      {"trb scenario watch", "trb scenario watch 3f2a --once --json"},
      0,
      1},
     run_watch},
    {{"scenario", "abort"},
     {"scenario abort RUN",
      "Ends a run for good; waits until every member that is not revoked has confirmed.",
      {"--reason TEXT|for the record", "--timeout S|how long to wait (5)", kAskedNode, kJson},
      {"trb scenario abort 3f2a --reason 'wrong box'"},
      1,
      1},
     run_abort},
    {{"scenario", "pause"},
     {"scenario pause RUN",
      "Holds a run: what runs is finished, nothing is begun, on every node that can be reached; the others when they "
      "come back. This stops no robot: trb stop does.",
      {"--reason TEXT|for the record", kAskedNode, kJson},
      {"trb scenario pause 3f2a --reason 'the hall is being cleaned'"},
      1,
      1},
     run_pause},
    {{"scenario", "resume"},
     {"scenario resume RUN",
      "Lets a run go on that was held.",
      {"--reason TEXT|for the record", kAskedNode, kJson},
      {"trb scenario resume 3f2a"},
      1,
      1},
     run_resume},
};

}  // namespace

std::vector<Command> scenario_commands() {
  return kScenarioCommands;
}

}  // namespace trb::cli
