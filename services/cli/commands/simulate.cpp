// simulate.
#include <algorithm>

#include "services/cli/commands/command.hpp"
#include "services/cli/commands/job_file.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/commands/played_run.hpp"
#include "services/cli/commands/replay.hpp"
#include "services/cli/commands/simulate_beside.hpp"
#include "services/cli/commands/simulate_fleet.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/simulator.hpp"

namespace trb::cli {
namespace {

using model::PaperParameters;

/// The job of the simulator, and the same fleet in the model's terms.
struct Simulation {
  std::uint64_t robots = 5, tasks = 9, interpreted = 0, sensors = 0, local = 0, remote = 0, faulty = 0;
  double rate = 1, seconds = 0, task_s = 3;

  Status read(const Arguments& arguments) {
    OptionReader reader(arguments);
    reader.read("--robots", robots);
    reader.read("--tasks", tasks);
    reader.read("--interpreted", interpreted);
    reader.read("--sensors", sensors);
    reader.read("--rate", rate);
    reader.read("--seconds", seconds);
    reader.read("--task-seconds", task_s);
    reader.read("--local-requests", local);
    reader.read("--remote-requests", remote);
    reader.read("--faulty", faulty);
    return reader.status();
  }

  [[nodiscard]] Value job(const std::string& trace) const {
    const auto integer = [](std::uint64_t number) { return Value{static_cast<std::int64_t>(number)}; };
    Value::Object out{{"robots", integer(robots)},
                      {"tasks", integer(tasks)},
                      {"interpreted", integer(interpreted)},
                      {"sensors", integer(sensors)},
                      {"rate", Value{rate}},
                      {"seconds", Value{seconds}},
                      {"task_seconds", Value{task_s}},
                      {"local_requests", integer(local)},
                      {"remote_requests", integer(remote)},
                      {"faulty", integer(faulty)}};
    if (!trace.empty()) out.emplace_back("trace", Value{trace});
    return Value{std::move(out)};
  }

  /// Tasks in turn: with one robot they are one block, else there is none.
  [[nodiscard]] PaperParameters parameters() const {
    PaperParameters p{.n = robots, .s = sensors, .R_l = local, .R_e = remote, .N_f = faulty};
    p.N_i = tasks / robots * interpreted + std::min(tasks % robots, interpreted);
    p.N_d = tasks - p.N_i;
    p.k = robots == 1 && tasks > 1 ? 1 : 0;
    p.sum_m = p.k * tasks;
    p.sum_x = rate * static_cast<double>(sensors);
    p.delta_t = seconds > 0 ? seconds : task_s * static_cast<double>(tasks);
    return p;
  }
};

std::string number_of(const Value& of, const char* key) {
  return std::to_string(of.find(key)->integer());
}

void print_simulation(const Value& answer, const PaperParameters& p) {
  std::vector<std::vector<std::string>> rows{
      {"PHASE", "MESSAGES", "EQUATION 12", "BYTES", "BETWEEN COMPUTERS", "BYTES"}};
  const auto add = [&](const std::string& name, const Value& of, double wanted) {
    const Value& between = *of.find("between_computers");
    rows.push_back({name, number_of(of, "messages"), shown_number(wanted), number_of(of, "bytes"),
                    number_of(between, "messages"), number_of(between, "bytes")});
  };
  for (const ModelTerm& term : model_terms()) {
    if (const Value* phase = answer.find("phases")->find(term.name)) add(term.name, *phase, term.value(p));
  }
  add("all", answer, model::total(p));
  print(format_table(rows));
  const double seconds = answer.find("seconds")->number();
  print_line("\n" + shown_number(seconds) + " s, " +
             shown_number(seconds > 0 ? answer.find("bytes")->number() / seconds : 0) +
             " bytes/s; tasks one after the other");
}

/// The job of the simulator with the real cores: only what was named, so that it refuses what this protocol has not.
Result<Value> world_job(const Arguments& arguments) {
  Value::Object out{{"protocol", Value{arguments.get("--protocol")}}};
  if (arguments.has("--at-once")) out.emplace_back("at_once", Value{true});
  struct Key {
    const char* option;
    const char* key;
    std::optional<std::uint64_t> usually = std::nullopt;
    bool whole = true;
  };
  OptionReader reader(arguments);
  for (const Key& one :
       {Key{"--robots", "robots", 5}, Key{"--tasks", "tasks", 9}, Key{"--runs", "runs"}, Key{"--seed", "seed"},
        Key{"--task-seconds", "task_seconds", {}, false}, Key{"--seconds", "seconds", {}, false},
        Key{"--sensors", "sensors"}, Key{"--rate", "rate", {}, false}, Key{"--interpreted", "interpreted"},
        Key{"--local-requests", "local_requests"}, Key{"--remote-requests", "remote_requests"},
        Key{"--faulty", "faulty"}}) {
    if (!one.usually && !arguments.has(one.option)) continue;
    std::uint64_t integer = one.usually.value_or(0);
    double number = 0;
    one.whole ? reader.read(one.option, integer) : reader.read(one.option, number);
    out.emplace_back(one.key, one.whole ? Value{static_cast<std::int64_t>(integer)} : Value{number});
  }
  if (!reader.status()) return reader.status().error();
  if (const Status added = add_link(out, arguments); !added) return added.error();
  if (arguments.has("--trace")) out.emplace_back("trace", Value{arguments.get("--trace")});
  add_list(out, arguments, "--relays", "relays");
  for (const auto& [option, key] : {std::pair{"--faults", "faults"}, std::pair{"--sensor-values", "sensor_values"}}) {
    if (const Status added = add_file(out, arguments, option, key); !added) return added.error();
  }
  return Value{std::move(out)};
}

void print_world(const Value& answer) {
  std::vector<std::vector<std::string>> rows{{"PHASE", "MESSAGES", "BYTES", "BETWEEN COMPUTERS", "BYTES"}};
  const auto add = [&](const std::string& name, const Value& of) {
    const Value& between = *of.find("between_computers");
    rows.push_back({name, number_of(of, "messages"), number_of(of, "bytes"), number_of(between, "messages"),
                    number_of(between, "bytes")});
  };
  for (const auto& [name, phase] : answer.find("phases")->object()) add(name, phase);
  add("all", answer);
  print(format_table(rows));
  const bool is_of_several = answer.find("beside") != nullptr;
  if (is_of_several) {
    print_line("");
    print_runs(answer);
  }
  const Value& world = *answer.find("world");
  const bool linked = world.find("all_linked")->boolean();
  print_line((is_of_several ? "\n"
                            : "\nThe run is " + world.find("state")->text() + ": " + number_of(world, "tasks_done") +
                                  " tasks in " + shown_number(world.find("makespan_s")->number()) + " s; ") +
             (linked ? "all links were up after " + shown_number(world.find("linked_s")->number()) + " s, " : "") +
             number_of(world, "events") + " events");
  print_run_end(answer);
}

void print_csv(const Value& answer) {
  const Value& over_time = *answer.find("over_time");
  const double step = over_time.find("interval_s")->number();
  std::string text = "time_s,messages,bytes\n";
  const Value::List& messages = over_time.find("messages")->list();
  const Value::List& bytes = over_time.find("bytes")->list();
  for (std::size_t i = 0; i < messages.size(); ++i) {
    text += shown_number(step * static_cast<double>(i)) + "," + std::to_string(messages[i].integer()) + "," +
            std::to_string(bytes[i].integer()) + "\n";
  }
  print(text);
}

int run_world(const Arguments& arguments) {
  const auto job = world_job(arguments);
  if (!job) return print_error(arguments, job.error());
  const auto answer = run_simulator(*job);
  if (!answer) return print_error(arguments, answer.error());
  if (arguments.has("--json")) {
    print_json(*answer);
  } else {
    arguments.has("--csv") ? print_csv(*answer) : print_world(*answer);
  }
  return exit_code_of(*answer);
}

int run_simulate(const Arguments& arguments) {
  if (arguments.has("--replay")) return run_replay(arguments);
  for (const char* option : {"--until", "--all"}) {
    if (!arguments.has(option)) continue;
    return print_error(arguments,
                       fail(Errc::bad_value, std::string(option) + ": of which trace?", "add --replay FILE"));
  }
  if (arguments.has("--fleet")) return run_simulate_fleet(arguments);
  for (const char* option : {"--scenario", "--times", "--one-less", "--beside"}) {
    if (!arguments.has(option)) continue;
    return print_error(arguments, fail(Errc::bad_value, std::string(option) + ": of which fleet?",
                                       "add --fleet DIR, the folder with its nodes' folders"));
  }
  if (arguments.has("--protocol") && arguments.get("--protocol") != "paper") return run_world(arguments);
  for (const char* option : {"--runs", "--at-once", "--link", "--seed", "--faults", "--relays", "--sensor-values"}) {
    if (!arguments.has(option)) continue;
    return print_error(arguments, fail(Errc::bad_value, std::string(option) + ": the paper's protocol has none",
                                       "add --protocol talkrobots"));
  }
  Simulation simulation;
  if (const Status status = simulation.read(arguments); !status) return print_error(arguments, status.error());
  const auto answer = run_simulator(simulation.job(arguments.get("--trace")));
  if (!answer) return print_error(arguments, answer.error());
  if (arguments.has("--json")) {
    print_json(*answer);
  } else if (arguments.has("--csv")) {
    print_csv(*answer);
  } else {
    print_simulation(*answer, simulation.parameters());
  }
  return kGood;
}

const std::vector<Command> kSimulateCommands = {
    {{"simulate"},
     {"simulate",
      "Plays a fleet in virtual time and counts its messages and bytes. Needs no node.\n"
      "The tasks are given to the robots in turn and done one after the other. Each message happens as an event: no "
      "equation\n"
      "is used; what the equations say stands beside it. A message is Figure 3's datagram: 32 bytes and its data.\n"
      "With --protocol talkrobots the real routers, schedulers, mode-adapters and the cloud's resilience service do "
      "it, over "
      "a\n"
      "simulated network; bytes are what ZMTP and CURVE put on the wire, without TCP and IP. What must hold is "
      "checked.\n"
      "A run that is not over says why: an alert waits for a person, it stands still, or its time was up. Exit status "
      "0:\n"
      "the run is FINISHED and nothing is BROKEN; else 1.",
      with_model_options(
          {"--robots N|robots of the fleet (5)",
           "--tasks N|tasks (9)",
           "--interpreted N|how many of the robots are told field by field (0)",
           "--task-seconds S|how long each task takes (3)",
           "--seconds S|until when sensors send updates (the last task's end); talkrobots: how long is played at most, "
           "from the run's submission, as the times of faults (some minutes more than all may take); 0: as without it",
           "--trace FILE|every message, a JSON object a line; at most a million",
           "--replay FILE|a kept trace of talkrobots as a sequence chart: what the run has sent between computers",
           "--until EVENT|with --replay: up to that event, which is played again; and what was at it",
           "--all|with --replay: also what is sent within computers, and upkeep",
           "--protocol NAME|paper, or talkrobots: the real cores (paper)",
           "--link NAME|talkrobots: lan, wifi or vpn (lan), or a FILE with delay, loss and bandwidth",
           "--runs N|talkrobots: the tasks are divided into so many runs, which go on at once (1)",
           "--at-once|talkrobots: within a run no robot waits for another one's task",
           "--seed N|talkrobots: one seed, one run (1)",
           "--faults FILE|talkrobots: what goes wrong and when: links, partitions, nodes, robots, batteries, clocks, "
           "disks",
           "--relays ID[,ID]|talkrobots: nodes that relay for two that do not reach each other (none)",
           "--sensor-values FILE|talkrobots: what sensors tell over time, for conditions on them",
           "--fleet DIR|your own: the folder with its nodes' folders; with --scenario",
           "--scenario FILE|what trb scenario run would start: who waits for whom, and the critical path",
           "--times FILE|with --fleet: {SKILL or \"task:ID\": seconds, or {\"mean\", \"deviation\"}}",
           "--beside FILE[@S]|with --fleet: another scenario at the same time, S seconds later (0); nine at most. Says "
           "what it costs each",
           "--one-less|with --fleet: the makespan without each robot, too; of each run",
           "--csv|messages and bytes over time",
           "--json|for programs: everything"}),
      {"trb simulate --robots 50 --tasks 100", "trb simulate --protocol talkrobots --robots 5 --tasks 9 --link wifi",
       "trb simulate --fleet fleet --scenario config/scenarios/paper-nine-tasks.json --one-less",
       "trb simulate --fleet fleet --scenario config/scenarios/paper-nine-tasks.json --beside second.json@10",
       "trb simulate --protocol talkrobots --robots 100 --tasks 1000 --runs 10 --at-once",
       "trb simulate --protocol talkrobots --faults faults.json --trace day.jsonl",
       "trb simulate --replay day.jsonl --until 1500", "trb simulate --robots 10 --tasks 100 --csv > distribution.csv",
       "trb simulate --robots 5 --tasks 9 --sensors 1 --seconds 180 --remote-requests 1 --faulty 1 --json"},
      0,
      0},
     run_simulate}};

}  // namespace

std::vector<Command> simulate_commands() {
  return kSimulateCommands;
}

}  // namespace trb::cli
