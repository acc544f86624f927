#include "common/drivers/modbus/syntax.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxAssignments = 64;
constexpr int kMaxItem = 99;
constexpr long kMaxAddress = 65535;

/// Words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) { skip_blanks(); }

  [[nodiscard]] bool done() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::string_view peek() const { return rest_.substr(0, rest_.find_first_of(" \t")); }
  std::string_view take() {
    const std::string_view word = peek();
    rest_.remove_prefix(word.size());
    skip_blanks();
    return word;
  }

 private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }
  std::string_view rest_;
};

template <class Number>
std::optional<Number> read_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<double> read_finite(std::string_view text) {
  const auto number = read_number<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

template <class E>
std::optional<E> one_of(std::string_view word) {
  constexpr auto kNames = enum_names(E{});
  const auto* const at = std::find(kNames.begin(), kNames.end(), word);
  if (at == kNames.end()) return std::nullopt;
  return static_cast<E>(at - kNames.begin());
}

Error bad(std::string what, std::string hint) {
  return fail(Errc::bad_value, std::move(what), std::move(hint));
}

Status read_address(Words& words, ModbusPlace& place) {
  const std::string_view word = words.take();
  const auto address = read_number<long>(word);
  if (!address) {
    return bad(in_quotes(word) + " is no address",
               "write KIND ADDRESS, for example " + std::string(name_of(place.kind)) + " 0");
  }
  if (*address < 0 || *address > kMaxAddress) {
    return bad("address " + std::string(word.substr(0, 24)) + " is outside 0 to 65535",
               "use the address as it travels, counted from 0: a manual's 40001 is holding 0, its 10001 discrete 0");
  }
  place.address = static_cast<std::uint16_t>(*address);
  return Done{};
}

Status read_type(Words& words, ModbusPlace& place) {
  const bool bit = place.kind == ModbusKind::coil || place.kind == ModbusKind::discrete;
  place.type = bit ? ModbusType::boolean : ModbusType::uint16;
  const std::string_view word = words.peek();
  if (words.done() || word == "*" || word == "+" || word == "-") return Done{};
  const auto type = one_of<ModbusType>(word);
  if (!type) {
    return bad(in_quotes(word) + " is no type",
               did_you_mean(word, {"bool", "int16", "uint16", "int32", "uint32", "float32"}, "use one of"));
  }
  words.take();
  if (bit && *type != ModbusType::boolean) {
    return bad("a " + std::string(name_of(place.kind)) + " holds one bit, no " + std::string(name_of(*type)),
               "leave the type out, or take a register: input or holding");
  }
  place.type = *type;
  if (words.peek() != "low_word_first") return Done{};
  words.take();
  if (place.size() == 1) {
    return bad("a " + std::string(name_of(*type)) + " has one word only", "remove low_word_first");
  }
  place.low_word_first = true;
  return Done{};
}

Status read_scale(Words& words, ModbusPlace& place) {
  const bool scaled = !words.done();
  if (words.peek() == "*") {
    words.take();
    const std::string_view word = words.take();
    const auto factor = read_finite(word);
    if (!factor || *factor == 0) return bad(in_quotes(word) + " is no factor", "write for example * 0.001");
    place.factor = *factor;
  }
  if (words.peek() == "+" || words.peek() == "-") {
    const double sign = words.take() == "-" ? -1 : 1;
    const std::string_view word = words.take();
    const auto offset = read_finite(word);
    if (!offset) return bad(in_quotes(word) + " is no offset", "write for example - 40");
    place.offset = sign * *offset;
  }
  if (!words.done()) {
    return bad(in_quotes(words.rest()) + " is left over",
               "write KIND ADDRESS [TYPE] [low_word_first] [* FACTOR] [+ OFFSET], with blanks between");
  }
  if (scaled && place.type == ModbusType::boolean) return bad("a bool has no factor and no offset", "remove them");
  return Done{};
}

struct Wanted {
  int item = ModbusAssignment::kLiteral;
  double literal = 0;
};

std::optional<Wanted> read_wanted(std::string_view word) {
  if (word == "{data}") return Wanted{ModbusAssignment::kWhole, 0};
  if (word == "true" || word == "false") return Wanted{ModbusAssignment::kLiteral, word == "true" ? 1.0 : 0.0};
  if (word.size() > 2 && word.front() == '{' && word.back() == '}') {
    const auto item = read_number<int>(word.substr(1, word.size() - 2));
    return item && *item >= 0 && *item <= kMaxItem ? std::optional(Wanted{*item, 0}) : std::nullopt;
  }
  const auto number = read_finite(word);
  return number ? std::optional(Wanted{ModbusAssignment::kLiteral, *number}) : std::nullopt;
}

/// A value's name, or a place written out.
Result<ModbusPlace> read_target(std::string_view text, const ModbusPlaces& values) {
  const auto known = values.find(text);
  if (known != values.end()) return known->second;
  if (one_of<ModbusKind>(Words(text).peek())) return read_modbus_place(text);
  std::vector<std::string> names;
  for (const auto& [name, ignored] : values) names.push_back(name);
  return fail(Errc::missing, in_quotes(text) + " is no name of \"values\" and no place",
              did_you_mean(text, names, "write a place such as coil 0, or one of"));
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r"), text.size()));
  text.remove_suffix(text.size() - (text.find_last_not_of(" \t\r") + 1));
  return text;
}

Result<ModbusPlace> read_writable(std::string_view text, const ModbusPlaces& values) {
  auto place = read_target(text, values);
  if (!place || place->writable()) return place;
  return bad(in_quotes(text) + " (" + to_text(*place) + ") cannot be written: discrete and input are read only",
             "write a coil or a holding register");
}

Result<ModbusAssignment> read_assignment(std::string_view line, const ModbusPlaces& values) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) {
    return bad(in_quotes(line) + " is no assignment", "write NAME = NUMBER, for example running = 1");
  }
  ModbusAssignment out;
  out.name = trimmed(line.substr(0, equals));
  const auto place = read_writable(out.name, values);
  if (!place) return place.error();
  out.place = *place;
  const std::string_view word = trimmed(line.substr(equals + 1));
  const auto wanted = read_wanted(word);
  if (!wanted) {
    return bad(in_quotes(word) + " is nothing that can be written",
               "write a number, true, false, {data}, or {0}, {1} … for the items of a list");
  }
  out.item = wanted->item;
  out.literal = wanted->literal;
  if (out.item != ModbusAssignment::kLiteral) return out;
  const auto words = modbus_words(out.place, out.literal);
  if (!words) return fail(words.error().code, out.name + ": " + words.error().what, words.error().hint);
  return out;
}

}  // namespace

Result<ModbusPlace> read_modbus_place(std::string_view text) {
  Words words(trimmed(text));
  const std::string_view word = words.take();
  const auto kind = one_of<ModbusKind>(word);
  if (!kind) {
    return bad(in_quotes(word) + " is no kind of register",
               did_you_mean(word, {"coil", "discrete", "input", "holding"}, "use one of"));
  }
  ModbusPlace place;
  place.kind = *kind;
  for (const auto read : {read_address, read_type, read_scale}) {
    if (const Status done = read(words, place); !done) return done.error();
  }
  if (place.address + place.size() - 1 > kMaxAddress) {
    return bad("a " + std::string(name_of(place.type)) + " takes two registers, and 65535 is the last one",
               "use an address up to 65534");
  }
  return place;
}

Result<std::vector<ModbusAssignment>> read_modbus_assignments(std::string_view text, const ModbusPlaces& values) {
  std::vector<ModbusAssignment> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    auto assignment = read_assignment(line, values);
    if (!assignment) return assignment.error();
    if (out.size() == kMaxAssignments) return bad("more than 64 assignments", "split it into several commands");
    out.push_back(std::move(*assignment));
  }
  return out;
}

std::string to_text(const ModbusPlace& place) {
  return std::string(name_of(place.kind)) + " " + std::to_string(place.address);
}

}  // namespace trb::drivers
