#include "services/cli/commands/scenario_check.hpp"

#include <algorithm>
#include <cstdio>

#include "common/base/files.hpp"
#include "common/scenario/definition.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

constexpr Duration kBinderWait = std::chrono::seconds(2);

Value spares_json(const std::vector<NoSpare>& without) {
  Value::List out;
  for (const NoSpare& one : without) {
    out.push_back(
        Value{Value::Object{{"task", Value{one.task}}, {"robot", Value{one.robot}}, {"why", Value{one.why}}}});
  }
  return Value{std::move(out)};
}

int print_good(const Arguments& arguments, const Scenario& scenario, const ConfigFaults& faults,
               const std::vector<NoSpare>* without) {
  if (arguments.has("--json")) {
    Value json = faults_json(faults);
    if (without != nullptr) std::get<Value::Object>(json.is).emplace_back("no_spare", spares_json(*without));
    print_json(json);
    return kGood;
  }
  std::fputs(to_text(faults).c_str(), stderr);
  print_line(arguments.words[0] + ": " + std::to_string(scenario.tasks.size()) + " tasks, no faults" +
             (without != nullptr ? "" : " (robots, skills, places and sensors were not checked: no --node)"));
  if (without == nullptr) return kGood;
  for (const NoSpare& one : *without) {
    print_line("no spare: " + one.task + " (" + (one.robot.empty() ? "nobody" : one.robot) + "): " + one.why);
  }
  return kGood;
}

bool is_reached(const Route& route) {
  return route.state == "self" || route.state == "ONLINE";
}

}  // namespace

/// Reads the file before a probe changes the working directory.
Scenario read_file_scenario(const std::string& path, ConfigFaults& faults) {
  auto text = read_file(path);
  if (!text) {
    faults.push_back(
        {path, "", text.error().what, "name a scenario file, for example config/scenarios/paper-nine-tasks.json"});
    return {};
  }
  auto json = parse_json(*text);
  if (!json) {
    faults.push_back({path, "", json.error().what, json.error().cure});
    return {};
  }
  return read_scenario(*json, path, faults);
}

Profiles profiles_of(const RouteTable& table) {
  Profiles out;
  for (const Route& route : table.routes) {
    NodeProfile& profile = out[route.id] = route.profile;
    if (!is_reached(route) && !profile.robot.empty()) profile.robot = route.state;
  }
  return out;
}

Binder find_binder(Probe& probe, const Scenario& scenario, const RouteTable& table) {
  if (std::ranges::none_of(scenario.tasks, [](const Task& task) { return task.robot.empty(); })) return {};
  const auto first = std::ranges::find(table.routes, Role::cloud, &Route::role);
  if (first == table.routes.end()) return {"", "the fleet has no cloud node"};
  const std::string name = "node '" + first->id + "', which decides, ";
  if (!is_reached(*first)) return {"", name + "is not reached"};
  const auto answer =
      probe.ask({.type = MessageType::request, .target = first->id, .body = AlertListRequest{}}, kBinderWait);
  if (!answer) return {"", name + "has no resilience that answers: " + answer.error().what};
  return {first->id, ""};
}

std::vector<std::string> robots_for(const Scenario& scenario, const Profiles& profiles, const Binder& binder,
                                    const std::string& path, ConfigFaults& faults) {
  check_scenario(scenario, profiles, path, faults);
  if (!faults_that_stop(faults).empty()) return {};
  warn_of_robots(scenario, profiles, path, faults);
  CandidateIndex candidates(profiles);
  return bind_tasks(scenario, candidates, binder.node, path, faults);
}

Value::List bound_json(const Scenario& scenario, const std::vector<std::string>& robots, const Binder& binder) {
  Value::List out;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const Task& task = scenario.tasks[i];
    if (!task.robot.empty()) continue;
    const std::string key = robots[i] == binder.node ? "by" : "robot";
    out.push_back(Value{Value::Object{{"task", Value{task.id}}, {key, Value{robots[i]}}}});
  }
  return out;
}

void print_bound(const Scenario& scenario, const std::vector<std::string>& robots, const Binder& binder,
                 const ConfigFaults& faults) {
  std::fputs(to_text(faults).c_str(), stderr);
  if (!binder.why_not.empty()) print_line("robots are chosen now, the first by id that can: " + binder.why_not);
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    if (!scenario.tasks[i].robot.empty()) continue;
    const bool later = robots[i] == binder.node;
    print_line("task " + scenario.tasks[i].id +
               (later ? ": " + robots[i] + " chooses its robot when it is due" : " is given to " + robots[i]));
  }
}

int run_scenario_check(const Arguments& arguments) {
  ConfigFaults faults;
  const std::string& path = arguments.words[0];
  const Scenario scenario = read_file_scenario(path, faults);
  if (!faults.empty()) return print_faults(arguments, faults);
  warn_of_skips(scenario, path, faults);
  if (!find_node(arguments).ok()) return print_good(arguments, scenario, faults, nullptr);
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto table = probe->ask_node<RouteTable>(RouteListRequest{});
  if (!table) return print_error(arguments, table.error());
  const Profiles profiles = profiles_of(*table);
  check_scenario(scenario, profiles, path, faults);
  warn_of_robots(scenario, profiles, path, faults);
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults);
  CandidateIndex candidates(profiles);
  const std::vector<NoSpare> without = tasks_without_spare(scenario, candidates);
  return print_good(arguments, scenario, faults, &without);
}

}  // namespace trb::cli
