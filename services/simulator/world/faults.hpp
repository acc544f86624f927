// What goes wrong, and when.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace trb::world {

enum class FaultKind : unsigned char { fail = 0, cut, heal, kill, start };
constexpr auto enum_names(FaultKind) {
  return std::array<std::string_view, 5>{"fail", "cut", "heal", "kill", "start"};
}

struct Fault {
  double at_s = 0;
  FaultKind kind{};
  std::string node;
  std::string other;  ///< cut, heal: the other end; empty: all others
};

}  // namespace trb::world
