// Questions to the person at the terminal.
#pragma once

#include <string>

namespace trb::cli {

/// True if somebody can answer: standard input and standard error are a terminal.
bool can_ask();

/// Prints the question, and `known` as what an empty line stands for; the line that is answered. Empty at the end of
/// the input.
std::string ask(const std::string& question, const std::string& known = {});

}  // namespace trb::cli
