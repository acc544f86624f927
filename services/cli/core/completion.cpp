#include "services/cli/core/completion.hpp"

namespace trb::cli {
namespace {

constexpr const char* kMade = "# Made by `trb completion`: do not edit.\n";

/// In single quotes, as all three shells read them.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += quote;
    } else {
      out += c;
    }
  }
  return out + "'";
}
std::string quoted_sh(const std::string& text) {
  return quoted(text, R"('\'')");
}
std::string quoted_fish(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '\\' ? std::string("\\\\") : std::string(1, c);
  return quoted(escaped, R"(\')");
}

std::string spaced(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

/// The options of a command, those that take a value, and of these the ones that take a folder or a file.
struct Options {
  std::vector<std::string> all;
  std::vector<std::string> valued;
  std::vector<std::string> folders;
  std::vector<std::string> files;
};
Options options_of(const CommandText& command) {
  Options out;
  for (const std::string& spec : command.usage.options) {
    const OptionText option = option_text(spec);
    out.all.push_back(option.name);
    if (option.kind != ValueKind::none) out.valued.push_back(option.name);
    if (option.kind == ValueKind::folder) out.folders.push_back(option.name);
    if (option.kind == ValueKind::file) out.files.push_back(option.name);
  }
  out.all.emplace_back("--help");
  return out;
}

const char* name_of_kind(ValueKind kind) {
  switch (kind) {
    case ValueKind::folder:
      return "folders";
    case ValueKind::file:
      return "files";
    default:
      return "";
  }
}

/// The first words of which a second one makes a command.
std::vector<std::string> first_words_of_two(const std::vector<CommandText>& commands) {
  std::vector<std::string> out;
  for (const std::string& first : words_after(commands, "")) {
    if (!words_after(commands, first).empty()) out.push_back(first);
  }
  return out;
}

std::vector<std::string> first_words(const std::vector<CommandText>& commands) {
  std::vector<std::string> out = words_after(commands, "");
  out.emplace_back("help");
  return out;
}

/// What a word means that begins several commands, or is one.
std::string meaning_of(const std::vector<CommandText>& commands, const std::string& first) {
  if (first == "help") return "Explains a command or a topic";
  for (const CommandText& command : commands) {
    if (command.name == std::vector{first}) return first_sentence(command.usage.summary);
  }
  return spaced(words_after(commands, first));
}

/// A line of a shell's case, for the words of one command and whatever follows them.
std::string shell_case(const CommandText& command, const std::string& options) {
  const Options of = options_of(command);
  const std::string name = joined_name(command);
  return "    '" + name + "' | '" + name + " '*)\n      options=" + options + "\n      valued='" + spaced(of.valued) +
         "' folders='" + spaced(of.folders) + "' files='" + spaced(of.files) + "' takes='" +
         name_of_kind(kind_of_words(command)) + "' ;;\n";
}

/// Pairs 'word:meaning' of zsh's _describe, one a line.
std::string described(const std::string& word, const std::string& meaning) {
  std::string name;
  for (const char c : word) name += c == ':' ? std::string("\\:") : std::string(1, c);
  return "      " + quoted_sh(name + ":" + meaning) + "\n";
}

std::string zsh_options(const CommandText& command) {
  std::string out = "(\n";
  for (const std::string& spec : command.usage.options) {
    const OptionText option = option_text(spec);
    out += described(option.name, option.what);
  }
  return out + described("--help", "what it does, its options, examples") + "    )";
}

}  // namespace

std::string bash_completion(const std::vector<CommandText>& commands) {
  std::string out =
      std::string(kMade) +
      "_trb() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local given=\"${COMP_WORDS[*]:1:COMP_CWORD-1}\" options='' valued='' folders='' files='' takes=''\n"
      "  COMPREPLY=()\n"
      "  case $given in\n";
  const std::string first = spaced(first_words(commands));
  out += "    '') mapfile -t COMPREPLY < <(compgen -W " + quoted_sh(first) + " -- \"$word\"); return ;;\n";
  for (const std::string& word : first_words_of_two(commands)) {
    out += "    '" + word + "') mapfile -t COMPREPLY < <(compgen -W " + quoted_sh(spaced(words_after(commands, word))) +
           " -- \"$word\"); return ;;\n";
  }
  for (const CommandText& command : commands) out += shell_case(command, quoted_sh(spaced(options_of(command).all)));
  return out +
         "  esac\n"
         "  case \" $folders \" in *\" $before \"*) takes=folders valued='' ;; esac\n"
         "  case \" $files \" in *\" $before \"*) takes=files valued='' ;; esac\n"
         "  case \" $valued \" in *\" $before \"*) return ;; esac\n"
         "  if [[ $word == -* ]]; then mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\"); return; fi\n"
         "  case $takes in\n"
         "    folders) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$word\") ;;\n"
         "    files) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- \"$word\") ;;\n"
         "  esac\n"
         "}\n"
         "complete -F _trb trb\n";
}

std::string zsh_completion(const std::vector<CommandText>& commands) {
  std::string out = "#compdef trb\n" + std::string(kMade) +
                    "_trb() {\n"
                    "  local word=${words[CURRENT]} before=${words[CURRENT-1]} given=\"${(j: :)words[2,CURRENT-1]}\"\n"
                    "  local valued='' folders='' files='' takes=''\n"
                    "  local -a options\n"
                    "  case $given in\n"
                    "    '') options=(\n";
  for (const std::string& word : first_words(commands)) out += described(word, meaning_of(commands, word));
  out += "    ); _describe command options; return ;;\n";
  for (const std::string& first : first_words_of_two(commands)) {
    out += "    '" + first + "') options=(\n";
    for (const CommandText& command : commands) {
      if (command.name.size() > 1 && command.name[0] == first)
        out += described(command.name[1], first_sentence(command.usage.summary));
    }
    out += "    ); _describe command options; return ;;\n";
  }
  for (const CommandText& command : commands) out += shell_case(command, zsh_options(command));
  return out +
         "  esac\n"
         "  case \" $folders \" in (*\" $before \"*) _files -/; return ;; esac\n"
         "  case \" $files \" in (*\" $before \"*) _files; return ;; esac\n"
         "  case \" $valued \" in (*\" $before \"*) return ;; esac\n"
         "  if [[ $word == -* ]]; then _describe -o option options; return; fi\n"
         "  case $takes in\n"
         "    (folders) _files -/ ;;\n"
         "    (files) _files ;;\n"
         "  esac\n"
         "}\n"
         "[[ ${funcstack[1]} == _trb ]] && _trb \"$@\"\n"
         "(( ${+functions[compdef]} )) && compdef _trb trb\n"
         "return 0\n";
}

std::string fish_completion(const std::vector<CommandText>& commands) {
  std::string out = std::string(kMade) +
                    "function __trb_is\n"
                    "  set -l given (commandline -opc)\n"
                    "  test \"$given[2..-1]\" = \"$argv\"\n"
                    "end\n"
                    "function __trb_in\n"
                    "  set -l given (commandline -opc)\n"
                    "  set -l last (math (count $argv) + 1)\n"
                    "  test (count $given) -ge $last; and test \"$given[2..$last]\" = \"$argv\"\n"
                    "end\n"
                    "complete -c trb -f\n"
                    "complete -c trb -l help -d 'what it does, its options, examples'\n";
  for (const std::string& word : first_words(commands))
    out += "complete -c trb -n __trb_is -a " + word + " -d " + quoted_fish(meaning_of(commands, word)) + "\n";
  for (const CommandText& command : commands) {
    const std::string name = joined_name(command);
    if (command.name.size() > 1) {
      out += "complete -c trb -n '__trb_is " + command.name[0] + "' -a " + command.name[1] + " -d " +
             quoted_fish(first_sentence(command.usage.summary)) + "\n";
    }
    const std::string here = "complete -c trb -n '__trb_in " + name + "' ";
    if (kind_of_words(command) == ValueKind::folder) out += here + "-a '(__fish_complete_directories)'\n";
    if (kind_of_words(command) == ValueKind::file) out += here + "-F\n";
    for (const std::string& spec : command.usage.options) {
      const OptionText option = option_text(spec);
      out += here + "-l " + option.name.substr(2) + " -d " + quoted_fish(option.what);
      if (option.kind == ValueKind::text) out += " -x";
      if (option.kind == ValueKind::folder) out += " -x -a '(__fish_complete_directories)'";
      if (option.kind == ValueKind::file) out += " -r -F";
      out += "\n";
    }
  }
  return out;
}

}  // namespace trb::cli
