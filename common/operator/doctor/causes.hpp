// What a router writes down of its links' troubles, in the words of people.
#pragma once

#include <string_view>

namespace trb::op {

struct Cause {
  std::string_view code;   ///< of a trouble
  std::string_view cause;  ///< what it is called here
  std::string_view what;
  std::string_view hint;
};

/// Null for a trouble that explains nothing by itself.
const Cause* cause_of(std::string_view code);

}  // namespace trb::op
