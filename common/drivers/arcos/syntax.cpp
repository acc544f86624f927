#include "common/drivers/arcos/syntax.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "common/drivers/text/next_word.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr int kInteger = 32767;
constexpr int kUnsigned = 65535;
constexpr std::size_t kMaxSteps = 32;
constexpr std::size_t kMaxFields = 32;

struct Command {
  std::string_view name;
  std::uint8_t number;
  ArcosEffect effect;
  int lowest = 0;  ///< both 0: no argument
  int highest = 0;
};

constexpr std::array<Command, 19> kCommands{{
    {"ENABLE", kArcosEnable, ArcosEffect::none, 0, 1},
    {"SETA", 5, ArcosEffect::none, -kInteger, kInteger},
    {"SETV", 6, ArcosEffect::none, 0, kInteger},
    {"SETO", 7, ArcosEffect::none},
    {"MOVE", 8, ArcosEffect::moves, -kInteger, kInteger},
    {"ROTATE", 9, ArcosEffect::moves, -kInteger, kInteger},
    {"SETRV", 10, ArcosEffect::none, 0, kInteger},
    {"VEL", 11, ArcosEffect::moves, -kInteger, kInteger},
    {"HEAD", 12, ArcosEffect::moves, -360, 360},
    {"DHEAD", 13, ArcosEffect::moves, -kInteger, kInteger},
    {"RVEL", 21, ArcosEffect::moves, -kInteger, kInteger},
    {"DCHEAD", 22, ArcosEffect::moves, -kInteger, kInteger},
    {"SETRA", 23, ArcosEffect::none, -kInteger, kInteger},
    {"SONAR", 28, ArcosEffect::none, 0, kUnsigned},
    {"STOP", 29, ArcosEffect::stops},
    {"DIGOUT", 30, ArcosEffect::none, 0, kUnsigned},
    {"VEL2", 32, ArcosEffect::moves, 0, kUnsigned},
    {"BUMPSTALL", 44, ArcosEffect::none, 0, 3},
    {"E_STOP", 55, ArcosEffect::stops},
}};

constexpr std::array<std::string_view, 17> kFields{
    "x",          "y",          "heading",        "velocity",        "rotation",
    "left",       "right",      "battery",        "state_of_charge", "stalled",
    "bumpers",    "motors",     "emergency_stop", "moving",          "compass",
    "digital_in", "digital_out"};

template <class Number>
std::optional<Number> whole_number(std::string_view text) {
  Number number{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// {data} or {0} to {99}.
bool is_placeholder(std::string_view text) {
  if (!text.starts_with('{') || !text.ends_with('}')) return false;
  const std::string_view inside = text.substr(1, text.size() - 2);
  return inside == "data" || (inside.size() <= 2 && !inside.empty() &&
                              std::ranges::all_of(inside, [](char c) { return c >= '0' && c <= '9'; }));
}

bool is_quoted(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"';
}

Error bad(std::string what, std::string hint) {
  return fail(Errc::bad_value, std::move(what), std::move(hint));
}

Status check_number(const ArcosStep& step) {
  if (is_placeholder(step.argument)) return Done{};
  const auto number = whole_number<int>(step.argument);
  if (!number) {
    return bad(step.name + " needs one whole number, not " + in_quotes(step.argument),
               "write it as " + step.name + " 100, or as " + step.name + " {0}");
  }
  if (*number >= step.lowest && *number <= step.highest) return Done{};
  return bad(step.name + ": " + step.argument + " is not from " + std::to_string(step.lowest) + " to " +
                 std::to_string(step.highest),
             "use a number in that range");
}

Result<ArcosStep> read_named(const Command& command, std::string_view rest) {
  ArcosStep step{std::string(command.name), command.number, command.effect,  {},
                 std::string(rest),         command.lowest, command.highest, {}};
  if (command.lowest == command.highest) {
    if (!rest.empty()) return bad(step.name + " takes no number", "remove " + in_quotes(rest));
    return step;
  }
  step.kind = ArcosStep::Argument::number;
  if (Status good = check_number(step); !good) return good.error();
  return step;
}

/// `command N`, `command N NUMBER` or `command N "TEXT"`.
Result<ArcosStep> read_numbered(std::string_view rest) {
  const std::string_view word = next_word(rest);
  const auto number = whole_number<int>(word);
  // 0 to 2 belong to the connection: PULSE, OPEN and CLOSE.
  if (!number || *number < 3 || *number > 255) {
    return bad(in_quotes(word) + " is no number of a command", "write it as command 92 1, with a number from 3 to 255");
  }
  ArcosStep step;
  step.name = "command " + std::string(word);
  step.command = static_cast<std::uint8_t>(*number);
  const auto* const known = std::ranges::find(kCommands, step.command, &Command::number);
  if (known != kCommands.end()) step.effect = known->effect;
  if (rest.empty()) return step;
  if (is_quoted(rest)) {
    step.kind = ArcosStep::Argument::text;
    step.argument = rest.substr(1, rest.size() - 2);
    return step;
  }
  step.kind = ArcosStep::Argument::number;
  step.argument = rest;
  step.lowest = -kInteger;
  step.highest = kUnsigned;
  if (Status good = check_number(step); !good) return good.error();
  return step;
}

/// `tolerance=MM` or `angle=DEG`.
Status read_setting(std::string_view word, ArcosTravel& travel) {
  const std::size_t equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const auto number = whole_number<double>(word.substr(equals + 1));
  if (name != "tolerance" && name != "angle") {
    return bad(in_quotes(name) + " is no setting of goto", "use tolerance=50 (millimetres) or angle=3 (degrees)");
  }
  // The robot itself turns by whole degrees, and drives by whole millimetres.
  const double lowest = name == "angle" ? 1 : 5;
  if (!number || !(*number >= lowest) || *number > 1000) {
    return bad(std::string(name) + " must be from " + std::to_string(static_cast<int>(lowest)) + " to 1000",
               "write it as tolerance=50 (millimetres) or angle=3 (degrees)");
  }
  (name == "angle" ? travel.angle : travel.tolerance) = *number;
  return Done{};
}

Result<ArcosStep> read_goto(std::string_view rest) {
  ArcosTravel travel;
  std::vector<std::string*> places{&travel.x, &travel.y, &travel.heading};
  std::size_t filled = 0;
  while (!rest.empty()) {
    const std::string_view word = next_word(rest);
    if (word.find('=') != std::string_view::npos) {
      if (Status good = read_setting(word, travel); !good) return good.error();
      continue;
    }
    if (filled == places.size() || (!is_placeholder(word) && !whole_number<double>(word))) {
      return bad("goto: " + in_quotes(word) + " is no number, and no more than three are taken",
                 "write it as goto {0} {1} {2}: x and y in millimetres, the heading in degrees");
    }
    *places[filled++] = word;
  }
  if (filled < 2) {
    return bad("goto needs x and y", "write it as goto {0} {1}, or as goto {0} {1} {2} with a heading");
  }
  ArcosStep step;
  step.name = "goto";
  step.effect = ArcosEffect::moves;
  step.travel = std::move(travel);
  return step;
}

Result<ArcosStep> read_step(std::string_view line) {
  const std::string_view word = next_word(line);
  if (word == "goto") return read_goto(line);
  if (word == "command") return read_numbered(line);
  const auto* const found = std::ranges::find(kCommands, word, &Command::name);
  if (found != kCommands.end()) return read_named(*found, line);
  std::vector<std::string> names{"goto", "command"};
  for (const Command& command : kCommands) names.emplace_back(command.name);
  return bad(in_quotes(word) + " is no step", did_you_mean(word, names, "use one of"));
}

}  // namespace

Result<std::vector<ArcosStep>> read_arcos_steps(std::string_view text) {
  std::vector<ArcosStep> steps;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (line.ends_with(' ')) line.remove_suffix(1);
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    if (!steps.empty() && steps.back().travel) {
      return bad("a line follows goto, whose end may be far", "make goto the last line");
    }
    if (steps.size() == kMaxSteps) return bad("more than 32 lines", "write fewer");
    auto step = read_step(line);
    if (!step) return step.error();
    steps.push_back(std::move(*step));
  }
  return steps;
}

Result<std::vector<ArcosField>> read_arcos_value(std::string_view text) {
  std::vector<ArcosField> fields;
  while (text.find_first_not_of(' ') != std::string_view::npos) {
    const std::string_view word = next_word(text);
    const auto* const found = std::ranges::find(kFields, word);
    if (found == kFields.end()) {
      return bad(in_quotes(word) + " is not told by the robot",
                 did_you_mean(word, {kFields.begin(), kFields.end()}, "use some of"));
    }
    if (fields.size() == kMaxFields) return bad("more than 32 fields", "use fewer");
    fields.push_back(static_cast<ArcosField>(found - kFields.begin()));
  }
  if (fields.empty()) return bad("is empty", "write for example \"x y heading\"");
  return fields;
}

}  // namespace trb::drivers
