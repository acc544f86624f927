// The errors that a router records for its links, as texts for people.
#pragma once

#include <string_view>

namespace trb::op {

struct Cause {
  std::string_view code;   ///< of a link error
  std::string_view cause;  ///< its name here
  std::string_view what;
  std::string_view hint;
};

/// Null for an error that explains nothing by itself.
const Cause* cause_of(std::string_view code);

}  // namespace trb::op
