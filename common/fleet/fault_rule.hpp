// A fault that shows in a robot's value: one entry of a description's "faults".
#pragma once

#include <string>

#include "proto/bodies/robot.hpp"
#include "proto/value.hpp"

namespace trb {

enum class FaultWhen : std::uint8_t { below = 0, above, equals, changes };
constexpr auto enum_names(FaultWhen) {
  return std::array<std::string_view, 4>{"below", "above", "equals", "changes"};
}

struct FaultRule {
  std::string name;
  std::string value;  ///< as the robot's mode knows it
  FaultWhen when{};
  double limit = 0;  ///< below, above
  double rearm = 0;  ///< below, above: the value at which the fault can be reported again
  Value wanted;      ///< equals: a number, a text, true or false
  Severity severity{};
  std::string capability;  ///< empty: every capability
  std::string text;        ///< for a person; empty: the rule's name
};

}  // namespace trb
