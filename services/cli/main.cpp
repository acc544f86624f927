// trb: the command line of TalkRoBots. See README.md.
#include <algorithm>
#include <cstdio>

#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

std::vector<Command> all_commands() {
  std::vector<Command> out;
#define TRB_ADD_GROUP(Name) \
  for (Command & command : Name##_commands()) out.push_back(std::move(command));
  TRB_COMMAND_GROUPS(TRB_ADD_GROUP)
#undef TRB_ADD_GROUP
  return out;
}

void print_overview(const std::vector<Command>& commands) {
  print_line("trb: probes and controls for a TalkRoBots fleet\n");
  for (const Command& command : commands) {
    std::string left = "  trb " + command.usage.words;
    left.resize(std::max<std::size_t>(left.size() + 2, 42), ' ');
    print_line(left + command.usage.summary.substr(0, command.usage.summary.find_first_of(".\n")));
  }
  print_line("\n`trb COMMAND --help` has options and examples; `trb help TOPIC` explains. " + topic_text(""));
}

const Command* find_command(const std::vector<Command>& commands, const std::vector<std::string>& given) {
  for (const Command& command : commands) {
    const std::size_t size = command.name.size();
    if (given.size() >= size && std::equal(command.name.begin(), command.name.end(), given.begin())) return &command;
  }
  return nullptr;
}

int help(const std::vector<Command>& commands, const std::vector<std::string>& words) {
  if (words.empty()) {
    print_overview(commands);
    return kGood;
  }
  if (const Command* command = find_command(commands, words)) {
    print(help_text(command->usage));
    return kGood;
  }
  const std::string text = topic_text(words[0]);
  if (!text.empty()) {
    print(text);
    return kGood;
  }
  std::fprintf(stderr, "trb: no topic '%s'\n%s", words[0].c_str(), topic_text("").c_str());
  return kWrongUse;
}

/// What can be known of arguments that were not understood: should the error be told to a program?
Arguments as_asked(const std::vector<std::string>& given) {
  Arguments out;
  if (std::find(given.begin(), given.end(), "--json") != given.end()) out.options["--json"] = "";
  return out;
}

int unknown(const std::vector<Command>& commands, const std::vector<std::string>& given) {
  std::string near;
  for (const Command& command : commands) {
    if (command.name[0] == given[0])
      near += (near.empty() ? "use trb " : ", trb ") + given[0] + " " + command.name.back();
  }
  const bool second = !near.empty() && given.size() > 1 && given[1].rfind("--", 0) != 0;
  const std::string words = given[0] + (second ? " " + given[1] : "");
  print_error(as_asked(given),
              fail(Errc::bad_value, "no command '" + words + "'", near.empty() ? "see trb help" : near));
  return kWrongUse;
}

int main_of(const std::vector<std::string>& given) {
  const std::vector<Command> commands = all_commands();
  if (given.empty() || given[0] == "--help" || given[0] == "help") {
    return help(commands, given.empty() ? given : std::vector<std::string>(given.begin() + 1, given.end()));
  }
  const Command* command = find_command(commands, given);
  if (command == nullptr) return unknown(commands, given);
  const std::vector<std::string> rest(given.begin() + static_cast<std::ptrdiff_t>(command->name.size()), given.end());
  for (const std::string& word : rest) {
    if (word != "--help") continue;
    print(help_text(command->usage));
    return kGood;
  }
  const auto arguments = parse_arguments(command->usage, rest);
  if (arguments) return command->run(*arguments);
  print_error(as_asked(rest), arguments.error());
  return kWrongUse;
}

}  // namespace
}  // namespace trb::cli

int main(int argc, char** argv) {
  try {
    return trb::cli::main_of({argv + 1, argv + argc});
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb: %s\n", problem.what());
    return 1;
  }
}
