// What goes wrong, and when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/simulator/world/clock.hpp"
#include "services/simulator/world/dice.hpp"

namespace trb::world {

enum class FaultKind : unsigned char {
  fail = 0,
  cut,
  heal,
  kill,
  start,
  partition,
  repair,
  clock,
  disk,
  battery,
  rate,
};
constexpr auto enum_names(FaultKind) {
  return std::array<std::string_view, 11>{"fail",   "cut",   "heal", "kill",    "start", "partition",
                                          "repair", "clock", "disk", "battery", "rate"};
}

/// Of what `node` sends (there), or is sent (back).
enum class Way : unsigned char { both = 0, there, back };
constexpr auto enum_names(Way) {
  return std::array<std::string_view, 3>{"both", "there", "back"};
}

struct Battery {
  double percent = 100;
  double per_second = 0;  ///< percent, while its robot works
};

/// Failures by chance.
struct FaultRate {
  double between_s = 600;          ///< mean time from one repair, or the submission, to the next failure
  std::optional<double> repair_s;  ///< none: it stays broken
};

struct Fault {
  double at_s = 0;
  FaultKind kind{};
  std::string node;
  std::string other{};               ///< cut, heal: the other end; empty: all others
  bool from_start = false;           ///< as long as the world exists, not from `at_s`
  Way way{};                         ///< cut, heal
  std::vector<std::string> nodes{};  ///< partition, heal: these on one side, all others on the other one
  ClockFault clock{};
  double commit_s = 0;  ///< disk: what a commit takes
  Battery battery{};
  FaultRate rate{};
};

/// A rate's failures and repairs of one robot until `limit_s`.
std::vector<Fault> drawn(const Fault& rate, const std::string& robot, double limit_s, Dice& dice);

}  // namespace trb::world
