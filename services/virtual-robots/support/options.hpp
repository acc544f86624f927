#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots {

/** A mistake on the command line; what() is one line for the user. */
struct OptionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** One option of a program. An option without a `value` name is a switch; `apply` then gets an empty string. */
struct Option {
  std::string name;
  std::string value;
  std::string help;
  std::function<void(std::string_view)> apply;
};

/** Applies the arguments to the options, in order. False when --help was asked for. */
bool parse_options(const std::vector<std::string>& arguments, const std::vector<Option>& options);

std::string describe_options(std::string_view program, std::string_view purpose, const std::vector<Option>& options);

/** A finite number within the limits, with nothing behind it; throws OptionError. */
double number_option(std::string_view text, double lowest, double highest);

}  // namespace trb::virtual_robots
