// robot conform.
#include <algorithm>
#include <filesystem>
#include <optional>

#include "common/base/number_text.hpp"
#include "common/config/node_config.hpp"
#include "common/config/robot_check.hpp"
#include "common/drivers/registry.hpp"
#include "proto/message.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/conform/cases.hpp"
#include "services/cli/core/host_port.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

using conform::Case;
using conform::CaseResult;

constexpr const char* kDocument = "proto/FIELD_CHANNEL.md";
constexpr std::size_t kNameWidth = 16;

struct Plan {
  conform::Settings settings;
  std::string address = "0.0.0.0";
  std::uint16_t port = 40000;
  Description description;
};

struct Row {
  Case tried;
  CaseResult result;
};

/// Where and for whom the node itself listens.
Result<Plan> plan_of_node(const Arguments& arguments, ConfigFaults& faults) {
  NodeCheck check = check_node_dir(arguments.words[0], true, drivers::robot_transports());
  for (const ConfigFault& fault : check.faults) {
    if (!fault.file.starts_with("keys")) faults.push_back(fault);
  }
  if (check.config.role == Role::cloud)
    return fail(Errc::bad_value, "a cloud node has no robot", "name a robot's node");
  Plan plan;
  plan.settings.own_id = check.config.id;
  plan.settings.from = check.config.robot.host;
  plan.address = check.config.network.robot_address;
  plan.port = check.config.network.tcp_port;
  plan.description = std::move(check.config.description);
  return plan;
}

Plan plan_of_file(const Arguments& arguments, ConfigFaults& faults) {
  RobotCheck check = check_robot_files({arguments.words[0], "", "", "", ""}, drivers::robot_transports());
  for (const ConfigFault& fault : check.faults) {
    if (fault.file == arguments.words[0] && fault.key != "skills") faults.push_back(fault);
  }
  Plan plan;
  plan.settings.own_id = "node";
  plan.description = std::move(check.description);
  return plan;
}

Status read_listen(const std::string& text, Plan& plan) {
  const HostPort at = split_address(text);
  const auto port = parse_number<std::uint16_t>(at.port);
  if (at.host.empty() || at.port.size() > 5 || !port) {
    return fail(Errc::bad_value, "--listen: '" + text + "' is no ADDRESS:PORT", "write, for example, 0.0.0.0:40000");
  }
  plan.address = at.host;
  plan.port = *port;
  return Done{};
}

Status read_run(const std::string& text, Plan& plan) {
  const std::size_t space = std::min(text.find(' '), text.size());
  const std::string name = text.substr(0, space);
  const Skill* skill = plan.description.find_skill(name);
  if (skill == nullptr) {
    return fail(Errc::unknown_skill, "--run: the description has no skill '" + name + "'",
                "name one of its skills, then its data as the robot gets it");
  }
  plan.settings.skill = skill->subtype;
  plan.settings.skill_data = text.substr(std::min(space + 1, text.size()));
  plan.settings.skill_timeout = seconds(skill->timeout_s);
  return Done{};
}

Status read_options(const Arguments& arguments, Plan& plan) {
  conform::Settings& settings = plan.settings;
  settings.channel = plan.description.field_channel;
  settings.from = arguments.get("--from", settings.from);
  settings.own_id = arguments.get("--id", settings.own_id);
  settings.echo = arguments.get("--echo", settings.echo);
  const auto wait = arguments.number("--wait", to_seconds(settings.first_dial));
  const auto patience = arguments.number("--timeout", to_seconds(settings.patience));
  if (!wait) return wait.error();
  if (!patience) return patience.error();
  settings.first_dial = seconds(*wait);
  settings.patience = seconds(*patience);
  if (arguments.get("--large") == "0") {
    settings.large = 0;
  } else {
    const auto large = arguments.number("--large", static_cast<double>(settings.large));
    if (!large) return large.error();
    settings.large = std::min(static_cast<std::size_t>(*large), kMaxDataSize);
  }
  if (arguments.has("--listen")) {
    if (Status good = read_listen(arguments.get("--listen"), plan); !good) return good;
  }
  return arguments.has("--run") ? read_run(arguments.get("--run"), plan) : Status(Done{});
}

Result<std::vector<Case>> chosen_cases(const Arguments& arguments) {
  std::vector<Case> cases = conform::all_cases();
  const std::string only = arguments.get("--only");
  if (only.empty()) return cases;
  std::erase_if(cases, [&](const Case& one) { return one.name != only; });
  if (cases.empty()) return fail(Errc::bad_value, "--only: no case '" + only + "'", "see trb robot conform --list");
  return cases;
}

int list_cases(const Arguments& arguments) {
  std::vector<std::vector<std::string>> rows{{"CASE", "SECTION", "TRIES THAT"}};
  Value::List list;
  for (const Case& one : conform::all_cases()) {
    rows.push_back({one.name, one.section, one.tries});
    list.push_back(Value{Value::Object{{"case", Value{std::string(one.name)}},
                                       {"section", Value{std::string(one.section)}},
                                       {"tries", Value{std::string(one.tries)}}}});
  }
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"cases", Value{std::move(list)}}}});
  } else {
    print(format_table(rows));
  }
  return kGood;
}

std::string name_of(CaseResult::Kind kind) {
  if (kind == CaseResult::Kind::good) return "ok";
  return kind == CaseResult::Kind::wrong ? "WRONG" : "not tried";
}

void print_row(const Row& row) {
  const CaseResult& result = row.result;
  const Colour colour = result.kind == CaseResult::Kind::good    ? Colour::good
                        : result.kind == CaseResult::Kind::wrong ? Colour::bad
                                                                 : Colour::dim;
  std::string kind = name_of(result.kind);
  kind.resize(11, ' ');
  std::string name = row.tried.name;
  name.resize(std::max(name.size() + 1, kNameWidth), ' ');
  print_line(coloured(colour, kind) + name + row.tried.tries);
  if (result.kind == CaseResult::Kind::good) return;
  const std::string indent(11, ' ');
  if (result.kind == CaseResult::Kind::not_tried) return print_line(indent + result.came);
  print_line(indent + "expected  " + result.expected);
  print_line(indent + "came      " + result.came);
  print_line(indent + "see       " + kDocument + ", \"" + row.tried.section + "\"");
}

std::size_t count_of(const std::vector<Row>& rows, CaseResult::Kind kind) {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [&](const Row& row) { return row.result.kind == kind; }));
}

void print_rows_json(const std::vector<Row>& rows) {
  Value::List list;
  for (const Row& row : rows) {
    list.push_back(Value{Value::Object{{"case", Value{std::string(row.tried.name)}},
                                       {"tries", Value{std::string(row.tried.tries)}},
                                       {"verdict", Value{name_of(row.result.kind)}},
                                       {"expected", Value{row.result.expected}},
                                       {"came", Value{row.result.came}},
                                       {"section", Value{std::string(row.tried.section)}}}});
  }
  const auto wrong = static_cast<std::int64_t>(count_of(rows, CaseResult::Kind::wrong));
  print_json(Value{Value::Object{{"cases", Value{std::move(list)}}, {"wrong", Value{wrong}}}});
}

/// Plays every case; a robot that is gone ends it.
std::vector<Row> play_all(const std::vector<Case>& cases, conform::Play& play, bool aloud) {
  std::vector<Row> rows;
  bool gone = false;
  for (const Case& one : cases) {
    CaseResult result{CaseResult::Kind::not_tried, "", "the robot is gone"};
    if (!gone) {
      play.begin();
      gone = !play.going();
      if (!gone) one.play(play);
      result = play.end();
    }
    rows.push_back({one, std::move(result)});
    if (aloud) print_row(rows.back());
  }
  return rows;
}

/// Waits for the robot, and plays every case against it.
int play_plan(const Arguments& arguments, const Plan& plan, const std::vector<Case>& cases) {
  conform::RobotEnd end;
  if (Status listens = end.listen(plan.address, plan.port); !listens) return print_error(arguments, listens.error());
  const bool aloud = !arguments.has("--json");
  if (aloud) {
    print_line("listening on " + plan.address + ":" + std::to_string(end.port()) +
               ": start the robot's program, it dials this as its node's TCP_PORT");
  }
  conform::Play play(end, plan.settings);
  const std::vector<Row> rows = play_all(cases, play, aloud);
  const std::size_t wrong = count_of(rows, CaseResult::Kind::wrong);
  if (aloud) {
    print_line(std::to_string(count_of(rows, CaseResult::Kind::good)) + " ok, " + std::to_string(wrong) + " wrong, " +
               std::to_string(count_of(rows, CaseResult::Kind::not_tried)) + " not tried");
  } else {
    print_rows_json(rows);
  }
  return wrong == 0 ? kGood : kFailed;
}

int run_conform(const Arguments& arguments) {
  if (arguments.has("--list")) return list_cases(arguments);
  if (arguments.words.empty()) {
    return print_error(arguments, fail(Errc::missing, "too few words", "trb robot conform ROBOT"));
  }
  ConfigFaults faults;
  const bool node = std::filesystem::is_directory(arguments.words[0]);
  auto plan = node ? plan_of_node(arguments, faults) : Result<Plan>(plan_of_file(arguments, faults));
  if (!faults.empty()) return print_faults(arguments, faults, "nothing was tried");
  if (!plan) return print_error(arguments, plan.error());
  if (Status good = read_options(arguments, *plan); !good) return print_error(arguments, good.error());
  const auto cases = chosen_cases(arguments);
  if (!cases) return print_error(arguments, cases.error());
  return play_plan(arguments, *plan, *cases);
}

const std::vector<Command> kRobotConformCommands = {
    {{"robot", "conform"},
     {"robot conform ROBOT",
      "Plays the middleware against a robot that you have programmed to speak proto/FIELD_CHANNEL.md, and tells "
      "case\n"
      "by case what it gets wrong. ROBOT is its description, or the folder of its node (which must be down). The "
      "robot\n"
      "dials in as it dials its node. Most cases need a robot that answers the request 'echo' with its own data.",
      {"--listen ADDRESS:PORT|where the robot dials (0.0.0.0:40000, or as the node does)",
       "--from ADDRESS|let only this robot in", "--id ID|of the robot's own node (node)",
       "--run 'SKILL DATA'|a skill that the robot may do, with the data as it gets them; it will move",
       "--large BYTES|the largest message (1000000); 0: none, for a controller that has no room for it",
       "--echo SUBTYPE|the request that comes back with its data (echo)",
       "--timeout S|how long to wait for an answer, or until the robot dials again (5)",
       "--wait S|how long to wait until the robot dials first (60)", "--only CASE|one case",
       "--list|which cases there are", kJson},
      {"trb robot conform config/robots/field-example.json --listen 127.0.0.1:40000",
       "trb robot conform nodes/mine --run 'go_to 1 0 0'", "trb robot conform --list"},
      0,
      1},
     run_conform}};

}  // namespace

std::vector<Command> robot_conform_commands() {
  return kRobotConformCommands;
}

}  // namespace trb::cli
