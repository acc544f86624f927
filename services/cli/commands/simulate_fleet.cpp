#include "services/cli/commands/simulate_fleet.hpp"

#include "common/fleet/did_you_mean.hpp"
#include "common/scenario/played_tasks.hpp"
#include "common/simulation/job_times.hpp"
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
  if (!hall.beside.empty()) hall.rest.emplace_back("beside", beside_job(hall.beside));
  if (Status read = add_file(hall.rest, arguments, "--sensor-values", "sensor_values"); !read) return read;
  for (auto& [key, value] : hall.rest) {
    if (key == "sensor_values") value = with_rules(std::move(value), hall.rules);
  }
  return add_numbers(hall, arguments);
}

/// What one robot less would change: a row for each.
struct OneLess {
  std::string robot;
  double makespan_s = 0;
  std::string why_not;  ///< the run is not accepted, or does not end
};

OneLess play_without(const Hall& hall, const std::string& robot) {
  const auto answer = run_simulator(hall.job_without(robot));
  if (!answer) return {robot, 0, answer.error().what};
  const Value& world = *answer->find("world");
  if (world.find("state")->text() != "FINISHED") return {robot, 0, "the run is " + world.find("state")->text()};
  return {robot, world.find("makespan_s")->number(), ""};
}

std::vector<OneLess> play_one_less(const Hall& hall) {
  std::vector<OneLess> out;
  for (const auto& [robot, profile] : hall.robots) out.push_back(play_without(hall, robot));
  return out;
}

void print_one_less(const std::vector<OneLess>& rows) {
  std::vector<std::vector<std::string>> out{{"WITHOUT", "MAKESPAN", ""}};
  for (const OneLess& one : rows) {
    out.push_back({one.robot, one.why_not.empty() ? seconds_text(one.makespan_s) + " s" : "-",
                   one.why_not.substr(0, one.why_not.find('\n'))});
  }
  print_line("");
  print(format_table(out));
}

Value one_less_json(const std::vector<OneLess>& rows) {
  Value::List out;
  for (const OneLess& one : rows) {
    Value::Object row{{"robot", Value{one.robot}}};
    if (one.why_not.empty())
      row.emplace_back("makespan_s", Value{one.makespan_s});
    else
      row.emplace_back("why_not", Value{one.why_not});
    out.push_back(Value{std::move(row)});
  }
  return Value{std::move(out)};
}

Value without_others(const Value& times, const Scenario& scenario) {
  Value::Object out;
  for (const auto& [name, time] : times.object()) {
    if (simulation::is_time_of(name, scenario)) out.emplace_back(name, time);
  }
  return Value{std::move(out)};
}

/// The same job with that run's scenario alone, submitted at once. Run 0 is the first.
Value job_alone(const Hall& hall, std::size_t run) {
  Value job = hall.job_without("");
  Value::Object out;
  for (auto& [key, value] : std::get<Value::Object>(job.is)) {
    if (key == "beside" || key == "trace") continue;
    if (key == "scenario" && run > 0) value = hall.beside[run - 1].json;
    if (key == "times" && value.is_object()) value = without_others(value, hall.scenarios()[run]);
    out.emplace_back(key, std::move(value));
  }
  return Value{std::move(out)};
}

/// What each run would take by itself, in seconds, or the error of its simulation; JSON null: it is not FINISHED then.
Result<std::vector<Value>> play_alone(const Hall& hall) {
  std::vector<Value> out;
  for (std::size_t run = 0; run <= hall.beside.size(); ++run) {
    const auto answer = run_simulator(job_alone(hall, run));
    if (!answer) return answer.error();
    const Value& world = *answer->find("world");
    const bool is_finished = world.find("state")->text() == "FINISHED";
    out.push_back(is_finished ? Value{world.find("makespan_s")->number()} : Value{});
  }
  return out;
}

/// By run.
std::vector<Value> waits_of_runs(const std::vector<PlayedTask>& tasks, std::size_t runs) {
  std::vector<Value> out;
  for (std::size_t run = 0; run < runs; ++run) out.push_back(waits_value(tasks, run));
  return out;
}

/// Where something goes wrong, a robot may have been replaced.
void print_criteria(bool has_faults) {
  if (has_faults)
    print_line("Who replaces whom is decided by the default criteria: the fleet's resilience.json is not read");
}

void print_all_runs(const Hall& hall, const Value& answer, const std::vector<Value>& alone_s, bool has_faults) {
  const std::vector<Scenario> scenarios = hall.scenarios();
  const std::vector<PlayedTask> tasks = played_tasks(answer, scenarios);
  for (std::size_t run = 0; run < scenarios.size(); ++run) {
    print_line("Run " + std::to_string(run + 1) + ", " + in_quotes(scenarios[run].name) + ":");
    print_waits(tasks, run);
    print_line("");
  }
  std::vector<std::string> alone;
  for (const Value& one : alone_s)
    alone.push_back(one.is_number() ? seconds_text(one.number()) + " s" : "not FINISHED");
  print_waits_key(tasks);
  print_line("");
  print_runs(answer, alone, waits_of_runs(tasks, scenarios.size()));
  const Value& between = *answer.find("between_computers");
  print_line("\n" + std::to_string(between.find("messages")->integer()) + " messages, " +
             std::to_string(between.find("bytes")->integer()) + " bytes between computers");
  print_criteria(has_faults);
  print_run_end(answer);
}

void add_beside_json(const Hall& hall, const std::vector<Value>& alone_s, Value& answer) {
  const auto waits = waits_of_runs(played_tasks(answer, hall.scenarios()), alone_s.size());
  auto& object = std::get<Value::Object>(answer.is);
  object.emplace_back("waits", waits.front());
  object.emplace_back("alone_s", alone_s.front());
  for (auto& [key, value] : object) {
    if (key != "beside") continue;
    auto& runs = std::get<Value::List>(value.is);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      auto& run = std::get<Value::Object>(runs[i].is);
      run.emplace_back("waits", waits[i + 1]);
      run.emplace_back("alone_s", alone_s[i + 1]);
    }
  }
}

/// Several scenarios at the same time, and each by itself.
int run_beside(const Arguments& arguments, const Hall& hall) {
  auto answer = run_simulator(hall.job_without(""));
  if (!answer) return print_error(arguments, answer.error());
  const auto alone_s = play_alone(hall);
  if (!alone_s) return print_error(arguments, alone_s.error());
  if (arguments.has("--json")) {
    add_beside_json(hall, *alone_s, *answer);
    print_json(*answer);
  } else {
    print_all_runs(hall, *answer, *alone_s, arguments.has("--faults"));
  }
  return exit_code_of(*answer);
}

void print_run(const Value& answer, const std::vector<PlayedTask>& tasks, bool has_faults) {
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
  if (!hall.beside.empty() && arguments.has("--one-less")) {
    faults.push_back({"--one-less", "", "is of one scenario", "leave it out, or leave --beside out"});
  }
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults, "nothing was simulated");
  if (const Status read = read_rest(hall, arguments); !read) return print_error(arguments, read.error());
  if (!hall.beside.empty()) return run_beside(arguments, hall);
  auto answer = run_simulator(hall.job_without(""));
  if (!answer) return print_error(arguments, answer.error());
  const std::vector<PlayedTask> tasks = played_tasks(*answer, hall.scenario);
  const auto one_less = arguments.has("--one-less") ? play_one_less(hall) : std::vector<OneLess>();
  if (arguments.has("--json")) {
    auto& object = std::get<Value::Object>(answer->is);
    object.emplace_back("waits", waits_value(tasks));
    if (!one_less.empty()) object.emplace_back("one_less", one_less_json(one_less));
    print_json(*answer);
  } else {
    print_run(*answer, tasks, arguments.has("--faults"));
    if (!one_less.empty()) print_one_less(one_less);
  }
  return exit_code_of(*answer);
}

}  // namespace trb::cli
