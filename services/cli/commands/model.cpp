// model.
#include <algorithm>
#include <set>

#include "common/fleet/did_you_mean.hpp"
#include "common/model/scenario_parameters.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/model_own.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/commands/scenario_check.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

using model::PaperParameters;

std::set<std::string> split(const std::string& text) {
  std::set<std::string> out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (end > begin) out.insert(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::vector<std::string> notes_of(const PaperParameters& p) {
  if (!(p == model::paper_worst_case())) return {};
  return {
      "The paper prints 297 for these parameters (section 6.2); its Equation 12 gives 299. 297 follows without the "
      "fault's "
      "two messages, or if the sensor's request is counted as a local one: the paper does not say which."};
}

Value parameters_value(const PaperParameters& p) {
  const auto integer = [](std::uint64_t number) { return Value{static_cast<std::int64_t>(number)}; };
  return Value{Value::Object{{"n", integer(p.n)},
                             {"N_d", integer(p.N_d)},
                             {"N_i", integer(p.N_i)},
                             {"k", integer(p.k)},
                             {"sum_m", integer(p.sum_m)},
                             {"s", integer(p.s)},
                             {"sum_x", Value{p.sum_x}},
                             {"delta_t", Value{p.delta_t}},
                             {"R_l", integer(p.R_l)},
                             {"R_e", integer(p.R_e)},
                             {"N_f", integer(p.N_f)}}};
}

void print_model_json(const PaperParameters& p, const std::vector<std::string>& notes) {
  Value::Object terms;
  for (const ModelTerm& term : model_terms()) terms.emplace_back(term.name, Value{term.value(p)});
  Value::List said;
  for (const std::string& note : notes) said.push_back(Value{note});
  print_json(Value{Value::Object{
      {"parameters", parameters_value(p)}, {"terms", Value{std::move(terms)}}, {"notes", Value{std::move(said)}}}});
}

void print_model(const PaperParameters& p, const std::vector<std::string>& notes) {
  std::vector<std::vector<std::string>> rows{{"TERM", "EQUATION", "IS", "MESSAGES"}};
  for (const ModelTerm& term : model_terms()) {
    rows.push_back({term.name, "(" + std::string(term.equation) + ")", term.formula, shown_number(term.value(p))});
  }
  print(format_table(rows));
  for (const std::string& note : notes) print_line("\n" + note);
}

Status read_parameters(const Arguments& arguments, PaperParameters& p) {
  OptionReader reader(arguments);
  reader.read("--robots", p.n);
  reader.read("--direct", p.N_d);
  reader.read("--interpreted", p.N_i);
  reader.read("--blocks", p.k);
  reader.read("--block-tasks", p.sum_m);
  reader.read("--sensors", p.s);
  reader.read("--local-requests", p.R_l);
  reader.read("--remote-requests", p.R_e);
  reader.read("--faulty", p.N_f);
  reader.read("--seconds", p.delta_t);
  double rate = 1;
  reader.read("--rate", rate);
  p.sum_x = rate * static_cast<double>(p.s);
  return reader.status();
}

Status check_robots(const Scenario& scenario, const std::set<std::string>& named) {
  std::vector<std::string> there;
  for (const Task& task : scenario.tasks) there.push_back(task.robot);
  for (const std::string& robot : named) {
    if (std::find(there.begin(), there.end(), robot) != there.end()) continue;
    return fail(Errc::unknown_target, "--interpreted: '" + robot + "' has no task in this scenario",
                did_you_mean(robot, there, "use one of"));
  }
  return Done{};
}

/// --interpreted names robots if the tasks come from a file, else it is the number of tasks.
int run_paper_model(const Arguments& given) {
  Arguments arguments = given;
  PaperParameters p;
  std::vector<std::string> notes;
  Scenario scenario;
  if (arguments.has("--scenario")) {
    ConfigFaults faults;
    scenario = read_file_scenario(arguments.get("--scenario"), faults);
    if (!faults.empty()) return print_faults(arguments, faults);
    const std::set<std::string> interpreted = split(arguments.get("--interpreted"));
    if (const Status known = check_robots(scenario, interpreted); !known) return print_error(arguments, known.error());
    const auto found = model::parameters_of(scenario, interpreted);
    arguments.options.erase("--interpreted");
    p = found.paper;
    notes = found.assumed;
  }
  Status status = read_parameters(arguments, p);
  if (status) status = model::check_named(scenario, p.n);
  if (status) status = model::check(p);
  if (!status) return print_error(arguments, status.error());
  for (const std::string& note : notes_of(p)) notes.push_back(note);
  arguments.has("--json") ? print_model_json(p, notes) : print_model(p, notes);
  return kGood;
}

int run_model(const Arguments& arguments) {
  const std::string protocol = arguments.has("--protocol") ? arguments.get("--protocol") : "paper";
  if (protocol != "paper" && protocol != "talkrobots") {
    return print_error(arguments,
                       fail(Errc::bad_value, "--protocol: '" + protocol + "' is none", "use paper or talkrobots"));
  }
  const bool own = protocol == "talkrobots";
  if (const Status fit = check_protocol_options(arguments, own); !fit) return print_error(arguments, fit.error());
  return own ? run_own_model(arguments) : run_paper_model(arguments);
}

std::vector<std::string> options_of(std::vector<std::string> options) {
  for (const std::string& one : own_model_options()) options.push_back(one);
  return with_model_options(std::move(options));
}

const std::vector<Command> kModelCommands = {
    {{"model"},
     {"model",
      "How many messages a run takes by the paper's Equations 1 to 12, term by term. Needs no node.\n"
      "With --scenario the tasks, robots, blocks and requests are read off the file; other options replace what was "
      "read. With --protocol talkrobots: what our own protocol sends between computers, by common/model/README.md; the "
      "options replace what follows from the scenario, or from tasks in turn (--robots 5 --tasks 9).",
      options_of(
          {"--scenario FILE|a scenario, for example config/scenarios/paper-nine-tasks.json",
           "--robots N|robots of the fleet, n (1)", "--direct N|tasks told in the modes direct or ros, N_d (0)",
           "--interpreted N|tasks told in the mode interpreter, N_i (0); with --scenario: the robots, ROBOT,ROBOT",
           "--blocks N|blocks of at least two tasks of one robot in a row, k (0)",
           "--block-tasks N|tasks in all these blocks, sum m_j (0)", "--seconds S|how long the run takes, delta_t (0)",
           "--json|for programs: parameters, terms, notes"}),
      {"trb model --robots 5 --direct 9 --blocks 1 --block-tasks 9 --local-requests 1 --sensors 1 --seconds 180",
       "trb model --robots 5 --interpreted 9 --remote-requests 1 --sensors 1 --seconds 180 --faulty 1",
       "trb model --scenario config/scenarios/paper-nine-tasks.json --interpreted ridgeback --seconds 180",
       "trb model --protocol talkrobots --robots 5 --tasks 9 --seconds 180"},
      0,
      0},
     run_model}};

}  // namespace

std::vector<Command> model_commands() {
  return kModelCommands;
}

}  // namespace trb::cli
