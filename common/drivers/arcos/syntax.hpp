// The notation of commands.json for a robot with ARCOS, the protocol of MobileRobots' Pioneers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

/// What a step is for the robot's motion.
enum class ArcosEffect : std::uint8_t { none, moves, stops };

/// Where the robot is to go, in its own frame: millimetres and degrees.
struct ArcosTravel {
  std::string x;  ///< a number, or {0}, {1} …
  std::string y;
  std::string heading;    ///< empty: any
  double tolerance = 50;  ///< how near, in millimetres
  double angle = 3;       ///< how near in heading, in degrees
};

/// One line of a command's words:
///   VEL {0}                      a command of the table in syntax.cpp with its number
///   command 42 "{data}"          any command by its number: with no argument, a number, or a text in quotes
///   goto {0} {1} [{2}] [tolerance=MM] [angle=DEG]     turns, drives and turns; always the last line
struct ArcosStep {
  enum class Argument : std::uint8_t { none, number, text };
  std::string name;  ///< for messages
  std::uint8_t command = 0;
  ArcosEffect effect{};
  Argument kind{};
  std::string argument;  ///< a number or a text, with {data} or {0}, {1} …
  int lowest = 0;
  int highest = 0;
  std::optional<ArcosTravel> travel;  ///< a goto; then `command` means nothing
};

constexpr std::uint8_t kArcosClose = 2;
constexpr std::uint8_t kArcosEnable = 4;
constexpr std::uint8_t kArcosStop = 29;

/// Errors: bad_value.
Result<std::vector<ArcosStep>> read_arcos_steps(std::string_view text);

/// The fields of the robot's information packets, by the names that "values" uses.
enum class ArcosField : std::uint8_t {
  x = 0,     ///< mm
  y,         ///< mm
  heading,   ///< degrees, -180 to 180
  velocity,  ///< mm/s
  rotation,  ///< degrees/s
  left,      ///< the left wheel, mm/s
  right,
  battery,          ///< V
  state_of_charge,  ///< percent
  stalled,
  bumpers,         ///< bits: front 1 to 7, rear 9 to 15
  motors,          ///< enabled
  emergency_stop,  ///< its button is pressed
  moving,
  compass,  ///< degrees
  digital_in,
  digital_out,
};

/// "FIELD ...", for example `x y heading`. Errors: bad_value.
Result<std::vector<ArcosField>> read_arcos_value(std::string_view text);

}  // namespace trb::drivers
