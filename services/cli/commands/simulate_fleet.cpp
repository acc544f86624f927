#include "services/cli/commands/simulate_fleet.hpp"

#include <algorithm>
#include <cstdio>

#include "common/scenario/played_tasks.hpp"
#include "proto/body.hpp"
#include "services/cli/commands/fleet_folders.hpp"
#include "services/cli/commands/job_file.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/commands/one_less.hpp"
#include "services/cli/commands/played_run.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/commands/sensor_values.hpp"
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
  Value::Object rest;  ///< of the job

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
  if (Status read = add_file(hall.rest, arguments, "--sensor-values", "sensor_values"); !read) return read;
  for (auto& [key, value] : hall.rest) {
    if (key == "sensor_values") value = with_rules(std::move(value), hall.rules);
  }
  return add_numbers(hall, arguments);
}

std::string seconds_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string end_text(const PlayedTask& of) {
  if (of.is_open) return "-";
  return seconds_text(of.end_s) + (of.has_failed ? " failed" : "");
}

constexpr double kShown_s = 0.5;  ///< a hand-over is shorter

std::string holder_text(const std::vector<PlayedTask>& tasks, const PlayedTask& of, const TaskWait& wait) {
  if (!wait.holder) return "";
  const PlayedTask& holder = tasks[*wait.holder];
  if (holder.id == of.id) return holder.robot + ", which failed at it";
  return wait.is_robot_busy ? holder.robot + ", which did " + holder.id : holder.id;
}

std::string wait_text(const std::vector<PlayedTask>& tasks, const PlayedTask& of, const TaskWait& wait) {
  const std::string holder = holder_text(tasks, of, wait);
  if (wait.more_s < kShown_s) return holder.empty() ? "-" : holder;
  return (holder.empty() ? "" : holder + "; then ") + seconds_text(wait.more_s) + " s for something else";
}

/// What the table cannot say.
void print_key(const std::vector<TaskWait>& waits) {
  const auto is_shown = [](const TaskWait& wait) { return wait.more_s >= kShown_s; };
  const auto is_on_path = [&](const TaskWait& wait) { return wait.is_critical && is_shown(wait); };
  print_line(std::string("* the critical path: the run is shorter only if one of these is") +
             (std::ranges::any_of(waits, is_on_path) ? ", or waits less for something else" : ""));
  if (std::ranges::any_of(waits, is_shown))
    print_line("something else: no task's end, but a result that was not there yet, a sensor's value, a decision");
}

void print_tasks(const std::vector<PlayedTask>& tasks) {
  std::vector<std::vector<std::string>> rows{{"TASK", "ROBOT", "BEGIN", "END", "WAITED FOR"}};
  const std::vector<TaskWait> waits = waits_of(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    rows.push_back({(waits[i].is_critical ? "* " : "  ") + tasks[i].id, tasks[i].robot, seconds_text(tasks[i].begin_s),
                    end_text(tasks[i]), wait_text(tasks, tasks[i], waits[i])});
  }
  print(format_table(rows));
  print_key(waits);
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

void print_run(const Value& answer, const std::vector<PlayedTask>& tasks, bool has_faults) {
  print_tasks(tasks);
  const Value& world = *answer.find("world");
  const Value& between = *answer.find("between_computers");
  print_line("\nThe run is " + world.find("state")->text() + ": " +
             std::to_string(world.find("tasks_done")->integer()) + " tasks in " +
             seconds_text(world.find("makespan_s")->number()) + " s; " +
             std::to_string(between.find("messages")->integer()) + " messages, " +
             std::to_string(between.find("bytes")->integer()) + " bytes between computers");
  if (has_faults)
    print_line("Who replaces whom is decided by the default criteria: the fleet's resilience.json is not read");
  print_run_end(answer);
}

}  // namespace

int run_simulate_fleet(const Arguments& arguments) {
  for (const char* option : {"--robots", "--tasks", "--interpreted", "--sensors", "--rate", "--local-requests",
                             "--remote-requests", "--faulty", "--csv"}) {
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
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults, "nothing was simulated");
  if (const Status read = read_rest(hall, arguments); !read) return print_error(arguments, read.error());
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
