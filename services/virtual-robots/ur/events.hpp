#pragma once

#include <optional>
#include <string>
#include <variant>

#include "services/virtual-robots/ur/packets.hpp"

namespace trb::virtual_robots::ur {

struct ProgramStarted {
  std::string name;
};
struct ProgramStopped {
  std::string name;
};
struct SecondaryRun {
  std::string name;
};
struct MoveStarted {
  MoveStep step;
};
struct SpeedStarted {
  SpeedStep step;
};
struct DigitalOutSet {
  DigitalOutStep step;
};
struct TextSaid {
  std::string text;
};
struct ScriptRefused {
  ScriptError error;
};
struct ErrorRaised {
  int code = 0;
  int argument = 0;
  ErrorLevel level = ErrorLevel::violation;
  std::string text;
};
struct SafetyChanged {
  SafetyMode mode = SafetyMode::normal;
};
struct Stopped {};

/** What the controller did; each has a line on stdout, and most have a packet for the primary clients. */
using Event = std::variant<ProgramStarted, ProgramStopped, SecondaryRun, MoveStarted, SpeedStarted, DigitalOutSet,
                           TextSaid, ScriptRefused, ErrorRaised, SafetyChanged, Stopped>;

std::optional<std::string> packet_of(const Event& event, std::uint64_t time_us);
std::string line_of(const Event& event);

}  // namespace trb::virtual_robots::ur
