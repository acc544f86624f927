#include "services/cli/io/questions.hpp"

#include <unistd.h>

#include <iostream>

#include "services/cli/io/print.hpp"

namespace trb::cli {

bool can_ask() {
  return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1;
}

std::string ask(const std::string& question, const std::string& known) {
  print_problem(question + (known.empty() ? "" : " [" + known + "]") + ": ");
  std::string line;
  if (!std::getline(std::cin, line)) return {};
  const auto begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos) return known;
  return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace trb::cli
