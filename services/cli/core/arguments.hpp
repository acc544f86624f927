// The command line: words and options, checked against what a command takes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/result.hpp"

namespace trb::cli {

/// What a command takes. An option that needs a value is written "--timeout S", a switch "--json".
struct Usage {
  std::string words;                 ///< "send TARGET TYPE SUBTYPE [DATA]"
  std::string summary;               ///< one line
  std::vector<std::string> options;  ///< "--timeout S|how long to wait for the answer (5)"
  std::vector<std::string> examples;
  std::size_t least = 0;  ///< positional words after the command's own
  std::size_t most = 0;
};

struct Arguments {
  std::vector<std::string> words;                           ///< after the command's own
  std::map<std::string, std::string> options;               ///< of one that was given several times, the last value
  std::map<std::string, std::vector<std::string>> every{};  ///< all values of each, in their order

  [[nodiscard]] bool has(const std::string& option) const { return options.count(option) != 0; }
  [[nodiscard]] std::string get(const std::string& option, const std::string& otherwise = {}) const;
  /// A positive number of seconds or things, `most` at most. Errors: bad_value.
  [[nodiscard]] Result<double> number(const std::string& option, double otherwise, double most = 1e9) const;
};

/// Errors: bad_value naming the word, with the nearest option as the hint.
Result<Arguments> parse_arguments(const Usage& usage, const std::vector<std::string>& given);

/// The text of `trb COMMAND --help`.
std::string help_text(const Usage& usage);

}  // namespace trb::cli
