#include "services/cli/commands/scenario_check.hpp"

#include "common/base/files.hpp"
#include "common/scenario/definition.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

Value spares_json(const std::vector<NoSpare>& without) {
  Value::List out;
  for (const NoSpare& one : without) {
    out.push_back(
        Value{Value::Object{{"task", Value{one.task}}, {"robot", Value{one.robot}}, {"why", Value{one.why}}}});
  }
  return Value{std::move(out)};
}

int print_good(const Arguments& arguments, std::size_t tasks, const ConfigFaults& faults,
               const std::vector<NoSpare>* without) {
  if (arguments.has("--json")) {
    Value json = faults_json(faults);
    if (without != nullptr) std::get<Value::Object>(json.is).emplace_back("no_spare", spares_json(*without));
    print_json(json);
    return kGood;
  }
  print_problem(to_text(faults));
  print_line(arguments.words[0] + ": " + std::to_string(tasks) + (tasks == 1 ? " task" : " tasks") + ", no faults" +
             (without != nullptr ? "" : " (robots, skills, places and sensors were not checked: no --node)"));
  if (without == nullptr) return kGood;
  for (const NoSpare& one : *without) {
    print_line("no spare: " + one.task + " (" + (one.robot.empty() ? "nobody" : one.robot) + "): " + one.why);
  }
  return kGood;
}

}  // namespace

Scenario read_file_scenario(const std::string& path, ConfigFaults& faults) {
  const auto text = read_file(path);
  if (text) return op::parse_scenario(*text, path, faults);
  faults.push_back(
      {path, "", text.error().what, "name a scenario file, for example config/scenarios/paper-nine-tasks.json"});
  return {};
}

int run_scenario_check(const Arguments& arguments) {
  ConfigFaults faults;
  const std::string& path = arguments.words[0];
  const Scenario scenario = read_file_scenario(path, faults);
  if (!faults.empty()) return print_faults(arguments, faults);
  warn_of_skips(scenario, path, faults);
  const std::size_t tasks = scenario.tasks.size();
  if (!is_node_named(arguments) && !find_node(arguments)) return print_good(arguments, tasks, faults, nullptr);
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto check = probe->wait<op::ScenarioCheck>(
      [&](op::Session& session, const auto& done) { op::check_with_fleet(session, scenario, path, done); });
  if (!check) return print_error(arguments, check.error());
  faults.insert(faults.end(), check->faults.begin(), check->faults.end());
  if (!faults_that_stop(faults).empty()) return print_faults(arguments, faults);
  return print_good(arguments, tasks, faults, &check->without_spare);
}

}  // namespace trb::cli
