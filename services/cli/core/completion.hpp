// Completion scripts of three shells, made from the table of commands.
#pragma once

#include <string>
#include <vector>

#include "services/cli/core/command_text.hpp"

namespace trb::cli {

/// For bash 4.4 or newer: completes commands, options, files and folders.
std::string bash_completion(const std::vector<CommandText>& commands);
/// For zsh 5: the same, with what each means.
std::string zsh_completion(const std::vector<CommandText>& commands);
/// For fish 3: the same, with what each means.
std::string fish_completion(const std::vector<CommandText>& commands);

}  // namespace trb::cli
