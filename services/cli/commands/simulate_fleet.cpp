#include "services/cli/commands/simulate_fleet.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"
#include "common/scenario/played_tasks.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/fleet_folders.hpp"
#include "services/cli/commands/job_file.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/commands/one_less.hpp"
#include "services/cli/commands/played_run.hpp"
#include "services/cli/commands/played_waits.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/commands/sensor_values.hpp"
#include "services/cli/commands/simulate_beside.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/simulator.hpp"

namespace trb::cli {
namespace {

/// A fleet's folders and a scenario, and what is to be played of them.
struct Hall {
  std::map<std::string, NodeProfile> robots;
  FolderSensors rules;
  Scenario scenario;
  std::vector<Beside> beside;
  Value::Object rest;  ///< of the job

  [[nodiscard]] std::vector<Scenario> scenarios() const {
    std::vector<Scenario> out{scenario};
    for (const Beside& one : beside) out.push_back(one.scenario);
    return out;
  }
  /// Empty: of the whole fleet.
  [[nodiscard]] Value job_without(const std::string& left_out) const {
    Value::List fleet;
    for (const auto& [id, profile] : robots) {
      if (id == left_out) continue;
      fleet.push_back(Value{Value::Object{{"id", Value{id}}, {"profile", *parse_json(to_json(profile))}}});
    }
    Value::Object job = left_out.empty() ? rest : without_robot(rest, left_out, fleet.size());
    job.emplace_back("fleet", Value{std::move(fleet)});
    return Value{std::move(job)};
  }
};

Status add_numbers(Hall& hall, const Arguments& arguments) {
  OptionReader reader(arguments);
  std::uint64_t seed = 1;
  double task_s = 3, until_s = 0;
  reader.read("--seed", seed);
  reader.read("--task-seconds", task_s);
  reader.read("--seconds", until_s);
  if (!reader.status()) return reader.status();
  hall.rest.emplace_back("seed", Value{static_cast<std::int64_t>(seed)});
  hall.rest.emplace_back("task_seconds", Value{task_s});
  if (until_s > 0) hall.rest.emplace_back("seconds", Value{until_s});
  if (Status added = add_link(hall.rest, arguments); !added) return added;
  if (arguments.has("--trace")) hall.rest.emplace_back("trace", Value{arguments.get("--trace")});
  return Done{};
}

Status read_rest(Hall& hall, const Arguments& arguments) {
  hall.rest.emplace_back("protocol", Value{"talkrobots"});
  if (Status read = add_file(hall.rest, arguments, "--scenario", "scenario"); !read) return read;
  if (Status read = add_file(hall.rest, arguments, "--times", "times"); !read) return read;
  if (Status read = add_file(hall.rest, arguments, "--faults", "faults"); !read) return read;
  add_list(hall.rest, arguments, "--relays", "relays");
  if (!hall.beside.empty()) {
    hall.rest.emplace_back("beside", beside_job(hall.beside));
    hall.rest.emplace_back("alone", Value{true});
  }
  if (Status read = add_file(hall.rest, arguments, "--sensor-values", "sensor_values"); !read) return read;
  for (auto& [key, value] : hall.rest) {
    if (key == "sensor_values") value = with_rules(std::move(value), hall.rules);
  }
  return add_numbers(hall, arguments);
}

/// A run without a robot.
struct RunLess {
  double makespan_s = 0;
  std::string why_not;  ///< it is not accepted, or does not end
};

/// What one robot less would change: a row for each.
struct OneLess {
  std::string robot;
  std::vector<RunLess> runs;
};

RunLess run_less(const Value& run) {
  if (run.find("state")->text() != "FINISHED") return {0, "the run is " + run.find("state")->text()};
  return {run.find("makespan_s")->number(), ""};
}

OneLess play_without(const Hall& hall, const std::string& robot) {
  const auto answer = run_simulator(hall.job_without(robot));
  OneLess out{robot, {}};
  for (std::size_t run = 0; run <= hall.beside.size(); ++run) {
    out.runs.push_back(answer ? run_less(run_of(*answer, run)) : RunLess{0, answer.error().what});
  }
  return out;
}

std::vector<OneLess> play_one_less(const Hall& hall) {
  std::vector<OneLess> out;
  for (const auto& [robot, profile] : hall.robots) out.push_back(play_without(hall, robot));
  return out;
}

std::vector<std::string> one_less_head(std::size_t runs) {
  if (runs == 1) return {"WITHOUT", "MAKESPAN", ""};
  std::vector<std::string> out{"WITHOUT"};
  for (std::size_t run = 1; run <= runs; ++run) out.push_back("RUN " + std::to_string(run));
  out.emplace_back("");
  return out;
}

/// A reason that all runs have is told once.
std::string why_not_text(const OneLess& one) {
  std::string out;
  for (std::size_t run = 0; run < one.runs.size(); ++run) {
    const std::string& why = one.runs[run].why_not;
    const std::string line = why.substr(0, why.find('\n'));
    const bool is_of_all = std::ranges::all_of(one.runs, [&](const RunLess& other) { return other.why_not == why; });
    if (is_of_all) return line;
    if (!line.empty()) out += (out.empty() ? "run " : "; run ") + std::to_string(run + 1) + ": " + line;
  }
  return out;
}

void print_one_less(const std::vector<OneLess>& rows) {
  std::vector<std::vector<std::string>> out{one_less_head(rows.front().runs.size())};
  for (const OneLess& one : rows) {
    std::vector<std::string>& row = out.emplace_back(std::vector{one.robot});
    for (const RunLess& run : one.runs) row.push_back(run.why_not.empty() ? seconds_text(run.makespan_s) + " s" : "-");
    row.push_back(why_not_text(one));
  }
  print_line("");
  print(format_table(out));
}

Value::Object run_less_json(const RunLess& run) {
  if (!run.why_not.empty()) return {{"why_not", Value{run.why_not}}};
  return {{"makespan_s", Value{run.makespan_s}}};
}

/// Of one run its keys stand in the row itself.
Value one_less_json(const std::vector<OneLess>& rows) {
  Value::List out;
  for (const OneLess& one : rows) {
    Value::Object row{{"robot", Value{one.robot}}};
    Value::List runs;
    for (const RunLess& run : one.runs) runs.push_back(Value{run_less_json(run)});
    if (runs.size() > 1) {
      row.emplace_back("runs", Value{std::move(runs)});
    } else {
      for (auto& member : run_less_json(one.runs.front())) row.push_back(std::move(member));
    }
    out.push_back(Value{std::move(row)});
  }
  return Value{std::move(out)};
}

/// Where something goes wrong, a robot may have been replaced.
void print_criteria(bool has_faults) {
  if (has_faults)
    print_line("Who replaces whom is decided by the default criteria: the fleet's resilience.json is not read");
}

void print_all_runs(const Hall& hall, const Value& answer, bool has_faults) {
  const std::vector<Scenario> scenarios = hall.scenarios();
  const std::vector<PlayedTask> tasks = played_tasks(answer, scenarios);
  for (std::size_t run = 0; run < scenarios.size(); ++run) {
    print_line("Run " + std::to_string(run + 1) + ", " + in_quotes(scenarios[run].name) + ":");
    print_waits(tasks, run);
    print_line("");
  }
  print_waits_key(tasks);
  print_line("");
  print_runs(answer);
  const Value& between = *answer.find("between_computers");
  print_line("\n" + std::to_string(between.find("messages")->integer()) + " messages, " +
             std::to_string(between.find("bytes")->integer()) + " bytes between computers");
  print_criteria(has_faults);
  print_run_end(answer);
}

void print_run(const Hall& hall, const Value& answer, bool has_faults) {
  const std::vector<PlayedTask> tasks = played_tasks(answer, hall.scenario);
  print_waits(tasks);
  print_waits_key(tasks);
  const Value& world = *answer.find("world");
  const Value& between = *answer.find("between_computers");
  print_line("\nThe run is " + world.find("state")->text() + ": " +
             std::to_string(world.find("tasks_done")->integer()) + " tasks in " +
             seconds_text(world.find("makespan_s")->number()) + " s; " +
             std::to_string(between.find("messages")->integer()) + " messages, " +
             std::to_string(between.find("bytes")->integer()) + " bytes between computers");
  print_criteria(has_faults);
  print_run_end(answer);
}

}  // namespace

int run_simulate_fleet(const Arguments& arguments) {
  for (const char* option : {"--runs", "--at-once", "--robots", "--tasks", "--interpreted", "--sensors", "--rate",
                             "--local-requests", "--remote-requests", "--faulty", "--csv"}) {
    if (!arguments.has(option)) continue;
    return print_error(arguments, fail(Errc::bad_value, std::string(option) + ": the fleet and the scenario say it",
                                       "leave it out, or leave --fleet out"));
  }
  if (arguments.has("--protocol") && arguments.get("--protocol") != "talkrobots") {
    return print_error(arguments,
                       fail(Errc::bad_value, "--protocol: a fleet of your own speaks talkrobots", "leave it out"));
  }
  Hall hall;
  ConfigFaults faults;
  hall.robots = read_fleet_folders(arguments.get("--fleet"), faults, &hall.rules);
  if (!arguments.has("--scenario")) {
    faults.push_back({"--scenario", "", "is missing", "name the scenario's file, as trb scenario run takes it"});
  } else {
    hall.scenario = read_file_scenario(arguments.get("--scenario"), faults);
  }
  hall.beside = read_beside(arguments, faults);
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults, "nothing was simulated");
  if (const Status read = read_rest(hall, arguments); !read) return print_error(arguments, read.error());
  auto answer = run_simulator(hall.job_without(""));
  if (!answer) return print_error(arguments, answer.error());
  add_waits(*answer, hall.scenarios());
  const auto one_less = arguments.has("--one-less") ? play_one_less(hall) : std::vector<OneLess>();
  if (arguments.has("--json")) {
    if (!one_less.empty()) std::get<Value::Object>(answer->is).emplace_back("one_less", one_less_json(one_less));
    print_json(*answer);
  } else {
    const bool has_faults = arguments.has("--faults");
    hall.beside.empty() ? print_run(hall, *answer, has_faults) : print_all_runs(hall, *answer, has_faults);
    if (!one_less.empty()) print_one_less(one_less);
  }
  return exit_code_of(*answer);
}

}  // namespace trb::cli
