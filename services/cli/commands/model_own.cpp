#include "services/cli/commands/model_own.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "common/base/files.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/model/own_parameters.hpp"
#include "common/model/scenario_parameters.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

using model::OwnParameters;
using model::OwnTerm;

struct CountOption {
  const char* variable;
  const char* option;
  const char* text;
  std::uint64_t OwnParameters::*count;
};

constexpr std::array kCounts{
    CountOption{"n", "--robots", "", &OwnParameters::robots},
    CountOption{"N", "--tasks", "tasks of the run, N; without a scenario they go to the robots in turn",
                &OwnParameters::tasks},
    CountOption{"M", "--members", "robots that have work in the run, M", &OwnParameters::members},
    CountOption{"B", "--batons", "from node to node, the first ones included, B", &OwnParameters::batons},
    CountOption{"S", "--spells", "how often a robot comes under the run's control and is let go, S",
                &OwnParameters::spells},
    CountOption{"K", "--kept", "batons that reach a robot under the run's control, K", &OwnParameters::kept},
    CountOption{"G", "--resumed", "tasks begun by such a robot, but not at the end of its task before, G",
                &OwnParameters::resumed},
    CountOption{"E", "--twice", "givers of a robot's first batons, beyond one, at the same moment, E",
                &OwnParameters::twice},
    CountOption{"D", "--crossed", "pairs of nodes that dial each other at once, D (0)", &OwnParameters::crossed},
    CountOption{"L", "--told", "profiles of robots connected after their node's links, L (0)", &OwnParameters::told},
    CountOption{"J", "--introduced", "lists of neighbours that the cloud has told, as a relay, J (0)",
                &OwnParameters::introduced},
    CountOption{"P", "--sensors", "", &OwnParameters::sensors},
    CountOption{"R", "--remote-requests", "", &OwnParameters::remote_requests},
    CountOption{"F", "--faulty", "", &OwnParameters::faulty},
    CountOption{"V", "--states", "changes of robots' values, V (0)", &OwnParameters::states},
    CountOption{"Q", "--bound", "tasks that name no robot, Q", &OwnParameters::bound},
    CountOption{"A", "--asked", "values that robots are asked for before a decision, A (0)", &OwnParameters::asked},
    CountOption{"W", "--end-asked", "questions of robots whose tasks are all done whether the run is over, W",
                &OwnParameters::end_asked}};

constexpr std::array<const char*, 5> kPaperAlone{"--direct", "--interpreted", "--blocks", "--block-tasks",
                                                 "--local-requests"};

Status read_parameters(const Arguments& arguments, OwnParameters& p) {
  OptionReader reader(arguments);
  for (const CountOption& one : kCounts) reader.read(one.option, p.*one.count);
  reader.read("--seconds", p.seconds);
  double rate = 0;
  reader.read("--rate", rate);
  p.updates = rate * static_cast<double>(p.sensors);
  return reader.status();
}

/// A number for a skill or a task, as `trb simulate --times` takes it, or the mean of {"mean", "deviation"}.
Result<std::map<std::string, double>> read_times(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return text.error();
  const auto json = parse_json(*text);
  if (!json) return fail(json.error().code, path + ": " + json.error().what, json.error().hint);
  std::map<std::string, double> out;
  if (!json->is_object()) return fail(Errc::bad_value, path + ": no object", R"(write {"SKILL": seconds})");
  for (const auto& [name, time] : json->object()) {
    const Value* mean = time.is_object() ? time.find("mean") : &time;
    if (mean == nullptr || !mean->is_number() || !kSeconds.holds(mean->number())) {
      return fail(Errc::bad_value, path + ": times." + name + ": no time", R"(write seconds, or {"mean": 3})");
    }
    out[name] = mean->number();
  }
  return out;
}

/// TASK=ROBOT, TASK=ROBOT: whom the cloud gives what names no robot.
Result<std::vector<std::string>> read_assigned(const Arguments& arguments, const Scenario& scenario) {
  std::vector<std::string> out(scenario.tasks.size());
  std::string rest = arguments.has("--bound-to") ? arguments.get("--bound-to") : "";
  while (!rest.empty()) {
    const std::string one = rest.substr(0, rest.find(','));
    rest.erase(0, one.size() + 1);
    const std::size_t equals = std::min(one.find('='), one.size());
    const auto task = std::ranges::find(scenario.tasks, one.substr(0, equals), &Task::id);
    if (task == scenario.tasks.end() || !task->robot.empty() || equals + 1 >= one.size()) {
      return fail(Errc::bad_value, "--bound-to: '" + one + "' is no task without a robot, and a robot for it",
                  "write TASK=ROBOT,TASK=ROBOT");
    }
    out[static_cast<std::size_t>(task - scenario.tasks.begin())] = one.substr(equals + 1);
  }
  return out;
}

Result<OwnParameters> of_file(const Arguments& arguments, const Scenario& scenario, double task_s) {
  std::map<std::string, double> times;
  if (arguments.has("--times")) {
    auto read = read_times(arguments.get("--times"));
    if (!read) return read.error();
    times = std::move(*read);
  }
  const auto assigned = read_assigned(arguments, scenario);
  if (!assigned) return assigned.error();
  return model::own_parameters_of(scenario, *assigned, model::task_times(scenario, times, task_s));
}

Result<OwnParameters> in_turn(const Arguments& arguments, double task_s) {
  OptionReader reader(arguments);
  std::uint64_t robots = 5, tasks = 9;
  reader.read("--robots", robots);
  reader.read("--tasks", tasks);
  if (!reader.status()) return reader.status().error();
  if (robots == 0 || tasks > kMaxTasks) {
    return robots == 0 ? fail(Errc::bad_value, "--robots: there is no robot", "use at least 1")
                       : fail(Errc::too_large, "--tasks: a run has at most " + std::to_string(kMaxTasks) + " tasks",
                              "use fewer");
  }
  OwnParameters p = model::own_parameters_of(model::tasks_in_turn(robots, tasks), {}, task_s);
  p.robots = robots;
  return p;
}

std::string shown_messages(double number) {
  return shown_number(static_cast<double>(std::llround(number * 1000)) / 1000);
}

Value own_value(const OwnParameters& p) {
  Value::Object parameters, phases;
  for (const CountOption& one : kCounts) {
    parameters.emplace_back(one.variable, Value{static_cast<std::int64_t>(p.*one.count)});
  }
  parameters.emplace_back("x", Value{p.updates});
  parameters.emplace_back("T", Value{p.seconds});
  Value::List terms;
  for (const OwnTerm& term : model::own_terms()) {
    terms.push_back(Value{Value::Object{{"term", Value{std::string(term.subtype)}},
                                        {"phase", Value{std::string(name_of(phase_of(term.subtype)))}},
                                        {"formula", Value{std::string(term.formula)}},
                                        {"by_time", Value{term.by_time}},
                                        {"messages", Value{term.value(p)}}}});
  }
  for (std::size_t i = 0; i < enum_names(CostPhase{}).size(); ++i) {
    const auto phase = static_cast<CostPhase>(i);
    phases.emplace_back(std::string(name_of(phase)), Value{own_messages(phase, p)});
  }
  return Value{Value::Object{{"parameters", Value{std::move(parameters)}},
                             {"terms", Value{std::move(terms)}},
                             {"phases", Value{std::move(phases)}},
                             {"messages", Value{own_total(p)}}}};
}

void print_terms(const OwnParameters& p) {
  std::vector<std::vector<std::string>> rows{{"PHASE", "TERM", "IS", "MESSAGES"}};
  for (const OwnTerm& term : model::own_terms()) {
    rows.push_back({std::string(name_of(phase_of(term.subtype))), std::string(term.subtype), std::string(term.formula),
                    shown_messages(term.value(p))});
  }
  rows.push_back({"all", "", "", shown_messages(own_total(p))});
  print(format_table(rows));
  std::string with;
  for (const CountOption& one : kCounts) {
    with.append(with.empty() ? "" : ", ").append(one.variable).append(" ").append(std::to_string(p.*one.count));
  }
  print_line("\nWith " + with + ", x " + shown_messages(p.updates) + "/s, T " + shown_messages(p.seconds) + " s.");
}

}  // namespace

int run_own_model(const Arguments& arguments) {
  OptionReader reader(arguments);
  double task_s = 3;
  reader.read("--task-seconds", task_s);
  if (!reader.status()) return print_error(arguments, reader.status().error());
  if (!kSeconds.holds(task_s)) {
    return print_error(arguments, fail(Errc::bad_value, "--task-seconds: is no time that a task takes",
                                       "write seconds, more than 0 and at most a week"));
  }
  OwnParameters p;
  Scenario scenario;
  if (arguments.has("--scenario")) {
    ConfigFaults faults;
    scenario = read_file_scenario(arguments.get("--scenario"), faults);
    if (!faults.empty()) return print_faults(arguments, faults);
    auto found = of_file(arguments, scenario, task_s);
    if (!found) return print_error(arguments, found.error());
    p = *found;
  } else {
    auto found = in_turn(arguments, task_s);
    if (!found) return print_error(arguments, found.error());
    p = *found;
  }
  Status status = read_parameters(arguments, p);
  if (status) status = model::check_named(scenario, p.robots);
  if (status) status = model::check(p);
  if (!status) return print_error(arguments, status.error());
  arguments.has("--json") ? print_json(own_value(p)) : print_terms(p);
  return kGood;
}

std::vector<std::string> own_model_options() {
  std::vector<std::string> out{"--protocol NAME|paper, or talkrobots: what is really sent between computers (paper)",
                               "--task-seconds S|of talkrobots: how long each task takes (3)",
                               "--bound-to WORDS|of talkrobots: whom the cloud gives what names no robot, "
                               "TASK=ROBOT,TASK=ROBOT",
                               "--times FILE|of talkrobots, with --scenario: {SKILL or \"task:ID\": seconds}"};
  for (const CountOption& one : kCounts) {
    if (*one.text != '\0') out.push_back(std::string(one.option) + " N|of talkrobots: " + one.text);
  }
  return out;
}

Status check_protocol_options(const Arguments& arguments, bool own) {
  std::string found;
  const auto look = [&](const std::string& option) {
    if (found.empty() && arguments.has(option)) found = option;
  };
  if (own) {
    for (const char* option : kPaperAlone) look(option);
  } else {
    for (const CountOption& one : kCounts) {
      if (*one.text != '\0') look(one.option);
    }
    look("--task-seconds");
    look("--times");
    look("--bound-to");
  }
  if (found.empty()) return Done{};
  return fail(Errc::bad_value, found + (own ? ": our own protocol has none" : ": the paper's equations have none"),
              own ? "leave it out; trb help model has its options" : "add --protocol talkrobots");
}

}  // namespace trb::cli
