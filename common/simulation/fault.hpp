// What goes wrong in a simulated fleet, and when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::simulation {

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

/// How a computer's UTC goes from now on.
struct ClockFault {
  double ahead_s = 0;          ///< of the true time; below 0: behind
  std::int64_t drift_ppm = 0;  ///< so many millionths too fast; below 0: too slow
  bool is_1970 = false;        ///< it counts from 1970, as without a battery; `ahead_s` has no part then
};

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
  std::string node{};
  std::string other{};               ///< cut, heal: the other end; empty: all others
  bool from_start = false;           ///< as long as the world exists, not from `at_s`
  Way way{};                         ///< cut, heal
  std::vector<std::string> nodes{};  ///< partition, heal: these on one side, all others on the other one
  ClockFault clock{};
  double commit_s = 0;  ///< disk: what a commit takes
  Battery battery{};
  FaultRate rate{};
};

}  // namespace trb::simulation
