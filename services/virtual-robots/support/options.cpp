#include "services/virtual-robots/support/options.hpp"

#include <algorithm>
#include <sstream>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots {
namespace {

const Option& find_option(std::string_view name, const std::vector<Option>& options) {
  auto found = std::find_if(options.begin(), options.end(), [&](const Option& option) { return option.name == name; });
  if (found == options.end()) throw OptionError("unknown option " + std::string(name));
  return *found;
}

}  // namespace

bool parse_options(const std::vector<std::string>& arguments, const std::vector<Option>& options) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--help") return false;
    const Option& option = find_option(arguments[i], options);
    if (option.value.empty()) {
      option.apply("");
      continue;
    }
    if (++i == arguments.size()) throw OptionError(option.name + " needs a value: " + option.value);
    option.apply(arguments[i]);
  }
  return true;
}

std::string describe_options(std::string_view program, std::string_view purpose, const std::vector<Option>& options) {
  std::ostringstream out;
  out << program << " - " << purpose << "\n\n";
  for (const Option& option : options) {
    std::string left = "  " + option.name + (option.value.empty() ? "" : " " + option.value);
    left.resize(std::max<std::size_t>(left.size() + 1, 34), ' ');
    out << left << option.help << "\n";
  }
  out << "  --help                          this text\n";
  return out.str();
}

double number_option(std::string_view text, double lowest, double highest) {
  auto number = parse_number(text);
  if (!number || *number < lowest || *number > highest)
    throw OptionError("not a number in its range: " + std::string(text));
  return *number;
}

}  // namespace trb::virtual_robots
