// The placeholders of a skill's data: {NAME} and {NAME.x|y|z|yaw}.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trb {

struct Placeholder {
  std::string name;
  std::string coordinate;  ///< "x", "y", "z", "yaw" … or empty
};

struct Template {
  std::vector<Placeholder> placeholders;
  std::string literal;  ///< the text around them
  bool well_formed = true;
};

/// A template is not well-formed if a '{' has no '}', or if it holds something other than a name.
Template parse_template(std::string_view text);

}  // namespace trb
