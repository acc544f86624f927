// trb completion, trb manual: what a shell and man know of trb, made from the same table as its help.
#include "common/fleet/did_you_mean.hpp"
#include "common/service/version.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/completion.hpp"
#include "services/cli/core/manual.hpp"
#include "services/cli/io/print.hpp"

namespace trb::cli {
namespace {

int completion(const Arguments& arguments) {
  const std::vector<CommandText> texts = texts_of(all_commands());
  const std::string& shell = arguments.words[0];
  if (shell == "bash") return print(bash_completion(texts)), kGood;
  if (shell == "zsh") return print(zsh_completion(texts)), kGood;
  if (shell == "fish") return print(fish_completion(texts)), kGood;
  const std::string near = nearest(shell, {"bash", "zsh", "fish"});
  print_error(arguments, fail(Errc::bad_value, "no completion for '" + shell + "'",
                              near.empty() ? "use bash, zsh or fish" : "did you mean: trb completion " + near + "?"));
  return kWrongUse;
}

int version(const Arguments& arguments) {
  if (arguments.has("--json"))
    return print_json(Value{Value::Object{{"version", Value{std::string(kVersion)}}}}), kGood;
  return print_line(std::string("trb ") + kVersion), kGood;
}

int manual(const Arguments&) {
  std::vector<std::pair<std::string, std::string>> topics;
  for (const std::string& name : topic_names()) topics.emplace_back(name, topic_text(name));
  print(manual_page(texts_of(all_commands()), topics, kVersion));
  return kGood;
}

}  // namespace

std::vector<Command> shell_commands() {
  return {
      {{"completion"},
       {"completion SHELL",
        "Prints a completion script for bash, zsh or fish, of every command and option. Packages install it; by hand "
        "a shell reads it at its start.",
        {},
        {"trb completion bash > ~/.local/share/bash-completion/completions/trb",
         "trb completion zsh > \"${fpath[1]}/_trb\"", "trb completion fish > ~/.config/fish/completions/trb.fish"},
        1,
        1},
       completion},
      {{"version"},
       {"version", "Prints the version of this build, as trb --version does.", {kJson}, {"trb version"}, 0, 0},
       version},
      {{"manual"},
       {"manual", "Prints the manual page trb(1), for man. Packages install it.", {}, {"trb manual | man -l -"}, 0, 0},
       manual}};
}

}  // namespace trb::cli
