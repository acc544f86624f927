// robot check.
#include <cstdio>

#include "common/config/robot_check.hpp"
#include "common/drivers/registry.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

std::string short_number(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

std::string parameters_of(const Skill& skill) {
  std::vector<std::string> words;
  for (const Parameter& parameter : skill.parameters) {
    std::string word = parameter.name + ": " + std::string(name_of(parameter.type));
    if (parameter.count) word += "[" + std::to_string(*parameter.count) + "]";
    if (!parameter.unit.empty()) word += " " + parameter.unit;
    words.push_back(parameter.required ? word : "[" + word + "]");
  }
  return joined(words, ", ");
}

std::string end_of(const SkillEnd& end) {
  switch (end.kind) {
    case EndKind::acknowledgement:
      return "the robot says so";
    case EndKind::state:
      return end.state + " = " + short_number(end.equals);
    case EndKind::position:
      return "within " + short_number(end.tolerance) + " of " + end.target;
    case EndKind::time:
      return "after " + short_number(end.duration_s) + " s";
  }
  return "-";
}

std::string spoken_text(const RobotCheck& check) {
  std::vector<std::string> words;
  for (const SpokenTo& one : check.spoken_to) {
    words.push_back(one.framework + " (" + std::string(name_of(one.mode)) + ", " + one.transport + ")");
  }
  return joined(words, ", ");
}

std::string channel_text(const Description& description) {
  if (!description.has_field_channel) return "-";
  const FieldChannel& channel = description.field_channel;
  const std::string chunk = channel.chunk_bytes == 0 ? "" : ", chunks of " + std::to_string(channel.chunk_bytes);
  return std::string(name_of(channel.framing)) + ", " + std::string(name_of(channel.encoding)) +
         (channel.acknowledge ? ", acknowledged" : ", not acknowledged") + chunk;
}

void print_good(const std::string& file, const RobotCheck& check) {
  const Description& robot = check.description;
  print(file + ": no faults\n\n");
  print(format_table({{"robot", robot.maker + " " + robot.model},
                      {"capabilities", joined(robot.capabilities, ", ")},
                      {"spoken to as", spoken_text(check)},
                      {"in fields", channel_text(robot)},
                      {"places", std::to_string(robot.places.size()) + " of its own, " +
                                     std::to_string(check.places.size()) + " of the hall"}}));
  std::vector<std::vector<std::string>> rows{{"SKILL", "CAPABILITY", "PARAMETERS", "SENDS", "HAS ENDED", "AT MOST"}};
  for (const Skill& skill : robot.skills) {
    rows.push_back({skill.name, skill.capability, parameters_of(skill), skill.subtype + " " + skill.data,
                    end_of(skill.end), short_number(skill.timeout_s) + " s"});
  }
  print("\n" + format_table(rows));
  for (const std::string& name : check.absent) {
    print_line("not checked: what " + name + " would tell; there is none beside it nor in the folder above");
  }
}

Value texts(const std::vector<std::string>& words) {
  Value::List list;
  for (const std::string& word : words) list.push_back(Value{word});
  return Value{std::move(list)};
}

Value good_json(const RobotCheck& check) {
  Value::List skills;
  for (const Skill& skill : check.description.skills) {
    skills.push_back(Value{Value::Object{{"name", Value{skill.name}},
                                         {"capability", Value{skill.capability}},
                                         {"parameters", Value{parameters_of(skill)}},
                                         {"subtype", Value{skill.subtype}},
                                         {"end", Value{std::string(name_of(skill.end.kind))}},
                                         {"timeout_s", Value{skill.timeout_s}}}});
  }
  Value::List spoken;
  for (const SpokenTo& one : check.spoken_to) {
    spoken.push_back(Value{Value::Object{{"framework", Value{one.framework}},
                                         {"mode", Value{std::string(name_of(one.mode))}},
                                         {"transport", Value{one.transport}}}});
  }
  return Value{Value::Object{{"faults", Value{Value::List{}}},
                             {"maker", Value{check.description.maker}},
                             {"model", Value{check.description.model}},
                             {"capabilities", texts(check.description.capabilities)},
                             {"spoken_to", Value{std::move(spoken)}},
                             {"skills", Value{std::move(skills)}},
                             {"not_checked", texts(check.absent)}}};
}

int run_robot_check(const Arguments& arguments) {
  const RobotCheck check =
      check_robot_files({arguments.words[0], arguments.get("--profile"), arguments.get("--commands"),
                         arguments.get("--places"), arguments.get("--framework")},
                        drivers::robot_transports());
  if (!check.faults.empty()) return print_faults(arguments, check.faults);
  if (arguments.has("--json")) {
    print_json(good_json(check));
  } else {
    print_good(arguments.words[0], check);
  }
  return kGood;
}

const std::vector<Command> kRobotCheckCommands = {
    {{"robot", "check"},
     {"robot check FILE",
      "Reads a robot's description and tells every fault at once: file, key, cure; or else what the robot can do.\n"
      "profile.json, commands.json and places.json are taken from beside it or from the folder above.",
      {"--framework NAME|whose words of commands.json are meant (its node.json's, else any that fit)",
       "--commands FILE|another commands.json", "--places FILE|another places.json",
       "--profile FILE|another profile.json", kJson},
      {"trb robot check config/robots/ur3.json", "trb robot check my-robot.json --framework lines"},
      1,
      1},
     run_robot_check}};

}  // namespace

std::vector<Command> robot_check_commands() {
  return kRobotCheckCommands;
}

}  // namespace trb::cli
