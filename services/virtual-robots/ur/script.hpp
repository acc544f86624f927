#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace trb::virtual_robots::ur {

inline constexpr std::size_t kJointCount = 6;
using Joints = std::array<double, kJointCount>;

struct Pose {
  std::array<double, 6> values{};
};

/** The last one is the value of what has none. */
using Value = std::variant<double, bool, std::string, std::vector<double>, Pose, std::monostate>;

/** movej or movel; a time above 0 has priority over the speed. */
struct MoveStep {
  std::string function;
  std::variant<Joints, Pose> target;
  double speed = 0;
  double time = 0;
  int line = 1;
  int column = 1;
};

/** speedj or speedl: joint speeds, or the tool's twist in the base's frame; a time of 0: until the speed is reached. */
struct SpeedStep {
  std::string function;
  std::array<double, 6> speeds{};
  double acceleration = 0;
  double time = 0;
};

struct SleepStep {
  double seconds = 0;
};

struct DigitalOutStep {
  int index = 0;
  bool on = false;
};

struct TextStep {
  std::string text;
};

/** stopj, stopl: brakes, and is over when the arm stands. */
struct HaltStep {
  double acceleration = 0;
};

/** set_tcp: from the flange to the tool's centre. */
struct ToolStep {
  Pose tool;
};

/** set_payload: checked and accepted, without a visible effect. */
struct SettingStep {
  std::string function;
};

/** write_output_...: a register that a client reads. */
struct RegisterStep {
  enum class Kind { integer, float_, boolean };
  Kind kind = Kind::integer;
  int index = 0;
  double value = 0;
};

struct ProtectiveStopStep {};

using Step = std::variant<MoveStep, SpeedStep, SleepStep, DigitalOutStep, TextStep, HaltStep, ToolStep, SettingStep,
                          RegisterStep, ProtectiveStopStep>;

/** The error of a script and its place; lines and columns count from 1. */
struct ScriptError {
  int line = 0;
  int column = 0;
  std::string text;
};

/** Carries the error out of the compiler. */
struct CompileFailure {
  ScriptError error;
};

/** The place of a line in its script, for errors. */
struct ScriptLine {
  int number = 1;
  std::string_view text;
};

[[noreturn]] void fail_syntax(const ScriptLine& line, int column);
[[noreturn]] void fail_with(const ScriptLine& line, int column, std::string text);

}  // namespace trb::virtual_robots::ur
