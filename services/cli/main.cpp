// trb: the command line of TalkRoBots. See README.md.
#include <algorithm>
#include <exception>

#include "common/fleet/did_you_mean.hpp"
#include "common/service/version.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

void print_row(const Command& command) {
  std::string left = "  trb " + command.usage.words;
  left.resize(std::max<std::size_t>(left.size() + 2, 42), ' ');
  print_line(left + first_sentence(command.usage.summary));
}

/// The commands whose first word is `group`; false if there is none.
bool print_group(const std::vector<Command>& commands, const std::string& group) {
  bool has = false;
  for (const Command& command : commands) {
    if (command.name[0] != group) continue;
    print_row(command);
    has = true;
  }
  if (has) print_line("\n`trb " + group + " COMMAND --help` has options and examples.");
  return has;
}

void print_overview(const std::vector<Command>& commands) {
  print("trb: probes and controls for a TalkRoBots fleet\n\n");
  for (const Command& command : commands) print_row(command);
  print("\n`trb COMMAND --help` has options and examples; `trb help TOPIC` explains. " + topic_text("") + "\n");
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
  const std::string text = topic_text(words[0]);
  if (const Command* command = find_command(commands, words)) {
    print(help_text(command->usage));
    if (words.size() == 1 && !text.empty()) print("\n" + text);  // a topic of the same name
    return kGood;
  }
  if (!text.empty()) {
    print(text);
    return kGood;
  }
  if (print_group(commands, words[0])) return kGood;
  const std::string near = nearest(words[0], topic_names());
  print_problem("trb: no topic '" + words[0] + "'\n" +
                (near.empty() ? topic_text("") : "did you mean: trb help " + near + "?\n"));
  return kWrongUse;
}

/// What can be known of arguments that were not understood: should the error be told to a program?
Arguments as_asked(const std::vector<std::string>& given) {
  Arguments out;
  if (std::find(given.begin(), given.end(), "--json") != given.end()) out.options["--json"] = "";
  return out;
}

/// The command that was probably meant, by all of the words that name one.
std::string meant(const std::vector<CommandText>& texts, const std::vector<std::string>& given) {
  std::vector<std::string> names;
  for (const CommandText& text : texts) names.push_back(joined_name(text));
  const bool second = given.size() > 1 && !given[1].starts_with("--");
  const std::string two = second ? nearest(given[0] + " " + given[1], names) : "";
  return two.empty() ? nearest(given[0], words_after(texts, "")) : two;
}

int unknown(const std::vector<Command>& commands, const std::vector<std::string>& given) {
  const std::vector<CommandText> texts = texts_of(commands);
  const std::vector<std::string> after = words_after(texts, given[0]);
  const bool second = !after.empty() && given.size() > 1 && !given[1].starts_with("--");
  const std::string near = meant(texts, given);
  std::string hint = near.empty() || near == given[0] ? "" : "did you mean: trb " + near + "?";
  if (hint.empty()) {
    for (const std::string& word : after) hint += (hint.empty() ? "use trb " : ", trb ") + given[0] + " " + word;
  }
  const std::string words = given[0] + (second ? " " + given[1] : "");
  print_error(as_asked(given),
              fail(Errc::bad_value, "no command '" + words + "'", hint.empty() ? "see trb help" : hint));
  return kWrongUse;
}

int main_of(const std::vector<std::string>& given) {
  const std::vector<Command> commands = all_commands();
  if (given.empty() || given[0] == "--help" || given[0] == "help") {
    return help(commands, given.empty() ? given : std::vector<std::string>(given.begin() + 1, given.end()));
  }
  if (given[0] == "--version") {
    print_line(std::string("trb ") + kVersion);
    return kGood;
  }
  const Command* command = find_command(commands, given);
  if (command == nullptr && given.back() == "--help" && print_group(commands, given[0])) return kGood;
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

/// What was not written is no success: a file of it would be taken for whole.
int with_output(int status) {
  if (status != kGood || lost_output().empty()) return status;
  print_problem("trb: io_error: not all of the output was written: " + lost_output() +
                "\n     make room (df -h), then run it again\n");
  return kFailed;
}

}  // namespace
}  // namespace trb::cli

int main(int argc, char** argv) {
  try {
    const int status = trb::cli::main_of({argv + 1, argv + argc});
    return trb::cli::with_output(status);
  } catch (const std::exception& problem) {
    const auto asked = trb::cli::as_asked({argv + 1, argv + argc});
    return trb::cli::print_error(asked, trb::fail(trb::Errc::io_error, problem.what(), "see trb doctor"));
  }
}
