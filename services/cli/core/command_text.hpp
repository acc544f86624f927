#pragma once

#include <string>
#include <vector>

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// A command as help, completion and the manual tell of it.
struct CommandText {
  std::vector<std::string> name;  ///< {"route", "list"}
  Usage usage;
};

/// What stands for the value of an option or for a word, from its name in capitals: FILE, NODE_DIR, ...
enum class ValueKind { none, text, folder, file };

/// An option's parts: "--timeout S|how long to wait" is {"--timeout", "S", "how long to wait", text}.
struct OptionText {
  std::string name;
  std::string value;  ///< empty: a switch
  std::string what;
  ValueKind kind = ValueKind::none;
};
OptionText option_text(const std::string& spec);

/// Of the first word behind the command's own: "up NODE_DIR" has a folder. none: it takes no words.
ValueKind kind_of_words(const CommandText& command);

/// The summary's first sentence, without its full stop.
std::string first_sentence(const std::string& summary);

/// The name as one writes it: "route list".
std::string joined_name(const CommandText& command);

/// What may follow this first word: {"list", "show"} of "run"; the first words themselves for "". In the table's order,
/// each once.
std::vector<std::string> words_after(const std::vector<CommandText>& commands, const std::string& first);

}  // namespace trb::cli
