#include "common/drivers/udp-at/syntax.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "common/fleet/did_you_mean.hpp"
#include "proto/value_words.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxLines = 8;
constexpr std::size_t kMaxText = 512;
constexpr double kMaxSeconds = 600;

using Types = std::vector<AtType>;

struct Shape {
  std::string_view name;
  AtAction action{};
  Types types;
};

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all = {
      {"PCMD", AtAction::move, {AtType::tilt, AtType::tilt, AtType::tilt, AtType::tilt}},
      {"hover", AtAction::hover, {}},
      {"FTRIM", AtAction::send, {}},
      {"CALIB", AtAction::send, {AtType::integer}},
      {"CONFIG", AtAction::send, {AtType::text, AtType::text}},
      {"LED", AtAction::send, {AtType::integer, AtType::real, AtType::integer}},
      {"ANIM", AtAction::send, {AtType::integer, AtType::integer}},
  };
  return all;
}

struct Word {
  std::string text;
  bool quoted = false;
};

Error bad(const std::string& what, std::string hint) {
  return fail(Errc::bad_value, what, std::move(hint));
}

/// The words of one line; a text in quotes is one word.
Result<std::vector<Word>> split(std::string_view line) {
  std::vector<Word> words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    if (line.empty()) return words;
    const bool quoted = line.front() == '"';
    const std::size_t end = quoted ? line.find('"', 1) : std::min(line.find(' '), line.size());
    if (end == std::string_view::npos) return bad("a text without its second quote", "close it with \"");
    words.push_back({std::string(quoted ? line.substr(1, end - 1) : line.substr(0, end)), quoted});
    line.remove_prefix(quoted ? end + 1 : end);
  }
}

/// The item's number of "{3}", kWhole for "{data}", kLiteral for anything else.
int item_of(std::string_view word) {
  if (word == "{data}") return AtArgument::kWhole;
  if (word.size() < 3 || word.size() > 4 || word.front() != '{' || word.back() != '}') return AtArgument::kLiteral;
  int item = 0;
  const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size() - 1, item);
  return error == std::errc() && end == word.data() + word.size() - 1 ? item : AtArgument::kLiteral;
}

Result<AtArgument> read_argument(AtType type, const Word& word) {
  if (word.quoted && word.text.find('{') != std::string::npos && word.text.find('}') != std::string::npos) {
    return bad("a placeholder within a text: \"" + word.text + "\"", "write {0} without quotes: they are added");
  }
  AtArgument argument{type, word.quoted ? AtArgument::kLiteral : item_of(word.text), {}};
  if (argument.item != AtArgument::kLiteral) return argument;
  if (word.quoted) {
    argument.literal = Value{word.text};
  } else if (auto value = parse_json(word.text); value && value->is_number()) {
    argument.literal = std::move(*value);
  } else {
    return bad(in_quotes(word.text) + " is no argument", R"(use a number, a "text" in quotes, or a placeholder {0})");
  }
  if (type == AtType::seconds) {
    if (const auto seconds = at_seconds(argument.literal); !seconds) return seconds.error();
  } else if (const auto literal = at_literal(type, argument.literal); !literal) {
    return literal.error();
  }
  return argument;
}

Result<AtLine> read_ref(const std::vector<Word>& words) {
  constexpr std::array<std::pair<std::string_view, AtAction>, 4> kStates{{{"take_off", AtAction::take_off},
                                                                          {"land", AtAction::land},
                                                                          {"emergency", AtAction::emergency},
                                                                          {"recover", AtAction::recover}}};
  std::vector<std::string> names;
  for (const auto& [name, action] : kStates) {
    if (words.size() == 2 && words[1].text == name) return AtLine{action, "REF", {}, {}};
    names.emplace_back(name);
  }
  return bad("REF takes one word: what the drone shall do",
             did_you_mean(words.size() < 2 ? "" : words[1].text, names, "use one of"));
}

/// Removes "for SECONDS" from the end.
Status read_duration(std::vector<Word>& words, AtLine& line) {
  if (words.size() < 2 || words[words.size() - 2].text != "for" || words[words.size() - 2].quoted) return Done{};
  if (line.action == AtAction::send) return bad(line.name + " is sent once and lasts no time", "remove \"for\"");
  auto seconds = read_argument(AtType::seconds, words.back());
  if (!seconds) return seconds.error();
  line.duration.push_back(std::move(*seconds));
  words.resize(words.size() - 2);
  return Done{};
}

Error unknown(const std::string& name) {
  std::vector<std::string> names = {"REF"};
  for (const Shape& shape : shapes()) names.emplace_back(shape.name);
  return bad(in_quotes(name) + " is no AT command that commands.json may use", did_you_mean(name, names, "use one of"));
}

Result<AtLine> read_line(std::string_view text) {
  auto words = split(text);
  if (!words) return words.error();
  const std::string name = words->front().text;
  if (name == "REF") return read_ref(*words);
  const auto shape = std::ranges::find(shapes(), name, &Shape::name);
  if (shape == shapes().end() || words->front().quoted) return unknown(name);
  AtLine line{shape->action, name, {}, {}};
  if (Status read = read_duration(*words, line); !read) return read.error();
  if (words->size() - 1 != shape->types.size()) {
    return bad(name + " has " + std::to_string(words->size() - 1) + " arguments, where " +
                   std::to_string(shape->types.size()) + " are needed",
               "see \"A drone's words\" in config/robots/README.md");
  }
  for (std::size_t i = 0; i < shape->types.size(); ++i) {
    auto argument = read_argument(shape->types[i], (*words)[i + 1]);
    if (!argument) return fail(argument.error().code, name + ": " + argument.error().what, argument.error().hint);
    line.arguments.push_back(std::move(*argument));
  }
  return line;
}

Result<std::string> integer_literal(const Value& value) {
  const bool whole = value.is_integer() || (value.is_number() && value.number() == std::floor(value.number()));
  if (!whole || std::abs(value.number()) > std::numeric_limits<std::int32_t>::max()) {
    return bad("is no whole number of 32 bits", "give a number such as 3");
  }
  return std::to_string(static_cast<std::int64_t>(value.number()));
}

Result<std::string> real_literal(const Value& value, double limit) {
  if (!value.is_number()) return bad("is " + in_words(value) + ", not a number", "give a number such as 0.5");
  if (!(std::abs(value.number()) <= limit)) {
    return bad("is out of its range",
               limit == 1 ? "give a part of the largest tilt or speed, from -1 to 1" : "give less");
  }
  return std::to_string(std::bit_cast<std::int32_t>(static_cast<float>(value.number())));
}

/// A value of CONFIG is always a text: numbers and truth values are written as one.
Result<std::string> text_literal(const Value& value) {
  if (value.is_list() || value.is_object()) return bad("is " + in_words(value) + ", not a text", "give a text");
  const std::string text = value.is_text()   ? value.text()
                           : value.is_bool() ? (value.boolean() ? "TRUE" : "FALSE")
                                             : dump_json(value);
  const bool plain = std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~' && c != '"'; });
  if (!plain) {
    return fail(Errc::not_escapable,
                "an AT command cannot carry a quote, a line's end, a control character or non-ASCII text",
                "use plain ASCII letters, digits and signs");
  }
  if (text.size() > kMaxText) return bad("has more than 512 characters", "use a shorter text");
  return '"' + text + '"';
}

}  // namespace

Result<std::vector<AtLine>> read_at_lines(std::string_view text) {
  std::vector<AtLine> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    auto read = read_line(line);
    if (!read) return read.error();
    lines.push_back(std::move(*read));
  }
  const auto flies = [](const AtLine& line) { return line.action != AtAction::send; };
  if (std::ranges::count_if(lines, flies) > 1) {
    return bad("has more than one line of REF, hover and PCMD",
               "the drone does one at a time: make two commands of it");
  }
  if (lines.size() > kMaxLines) return bad("has more than 8 lines", "make two commands of it");
  return lines;
}

Result<std::string> at_literal(AtType type, const Value& value) {
  switch (type) {
    case AtType::integer:
      return integer_literal(value);
    case AtType::real:
      return real_literal(value, std::numeric_limits<float>::max());
    case AtType::tilt:
      return real_literal(value, 1);
    case AtType::text:
    case AtType::seconds:
      break;
  }
  return text_literal(value);
}

Result<double> at_seconds(const Value& value) {
  if (value.is_number() && value.number() > 0 && value.number() <= kMaxSeconds) return value.number();
  return bad("is no duration", "give seconds: more than 0, at most 600");
}

bool at_tells_end(const AtLine& line) {
  if (line.action == AtAction::send) return false;
  return line.action != AtAction::hover || !line.duration.empty();
}

const std::vector<std::string>& at_value_names() {
  static const std::vector<std::string> names = {"battery",
                                                 "altitude",
                                                 "state",
                                                 "yaw",
                                                 "pitch",
                                                 "roll",
                                                 "vx",
                                                 "vy",
                                                 "vz",
                                                 "airborne",
                                                 "landed",
                                                 "flying",
                                                 "motors_problem",
                                                 "com_lost",
                                                 "software_fault",
                                                 "battery_low",
                                                 "angles_out_of_range",
                                                 "too_much_wind",
                                                 "ultrasound_deaf",
                                                 "cutout",
                                                 "com_watchdog",
                                                 "emergency"};
  return names;
}

}  // namespace trb::drivers
