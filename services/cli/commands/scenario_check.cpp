#include "services/cli/commands/scenario_check.hpp"

#include "common/base/files.hpp"
#include "common/scenario/definition.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

const std::string kNotLooked = "trb: robots, skills, places and sensors were not checked: ";

bool has_node(const Arguments& arguments) {
  return is_node_named(arguments) || find_node(arguments);
}

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
    std::get<Value::Object>(json.is).emplace_back("fleet_checked", Value{without != nullptr});
    if (without != nullptr) std::get<Value::Object>(json.is).emplace_back("no_spare", spares_json(*without));
    print_json(json);
    return kGood;
  }
  print_problem(to_text(faults));
  print_line(arguments.words[0] + ": " + std::to_string(tasks) + (tasks == 1 ? " task" : " tasks") + ", no faults" +
             (without != nullptr ? "" : " (robots, skills, places and sensors were not checked: no --node)"));
  if (without == nullptr) return kGood;
  for (const NoSpare& one : *without) {
    print_line("no spare: " + one.task + " (" + (one.robot.empty() ? "no robot yet" : one.robot) + "): " + one.why);
  }
  return kGood;
}

/// `why_not`: why the fleet was not asked; empty: it was.
int print_bad(const Arguments& arguments, const ConfigFaults& faults, const std::string& why_not) {
  if (arguments.has("--json")) {
    Value json = faults_json(faults);
    std::get<Value::Object>(json.is).emplace_back("fleet_checked", Value{why_not.empty()});
    print_json(json);
    return kFailed;
  }
  print_faults(arguments, faults);
  if (!why_not.empty()) print_problem(kNotLooked + why_not + "\n");
  return kFailed;
}

Result<op::ScenarioCheck> ask_fleet(Probe& probe, const Scenario& scenario, const std::string& path,
                                    const ConfigFaults& faults) {
  return probe.wait<op::ScenarioCheck>(
      [&](op::Session& session, const auto& done) { op::check_with_fleet(session, scenario, path, faults, done); });
}

/// A file with faults: what the fleet says of it besides, if there is a node to ask.
int check_faulty(const Arguments& arguments, const Scenario& scenario, const ConfigFaults& faults) {
  if (scenario.tasks.empty()) return print_bad(arguments, faults, "no task could be read");
  if (!has_node(arguments)) return print_bad(arguments, faults, "no --node");
  const auto dir = find_node(arguments);
  auto probe = dir ? Probe::open(*dir) : Result<std::unique_ptr<Probe>>(dir.error());
  if (!probe) return print_bad(arguments, faults, probe.error().what);
  const auto check = ask_fleet(**probe, scenario, arguments.words[0], faults);
  return check ? print_bad(arguments, check->faults, "") : print_bad(arguments, faults, check.error().what);
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
  if (!faults.empty()) return check_faulty(arguments, scenario, faults);
  const std::size_t tasks = scenario.tasks.size();
  if (!has_node(arguments)) {
    warn_of_skips(scenario, path, faults);
    return print_good(arguments, tasks, faults, nullptr);
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto check = ask_fleet(*probe, scenario, path, {});
  if (!check) return print_error(arguments, check.error());
  if (!faults_that_stop(check->faults).empty()) return print_bad(arguments, check->faults, "");
  return print_good(arguments, tasks, check->faults, &check->without_spare);
}

}  // namespace trb::cli
