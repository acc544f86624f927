#include "common/drivers/c3/krl.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxComponents = 64;
constexpr double kMostWhole = 9007199254740992;  // 2^53: beyond it a double is no exact whole number

bool is_plain(char c) {
  return c >= ' ' && c <= '~' && c != '"';
}

std::string escaped(char c) {
  if (c == '\\') return "\\\\";
  if (c == '"') return "\\q";
  if (c == '\n') return "\\n";
  if (c == '\r') return "\\r";
  if (is_plain(c)) return std::string(1, c);
  std::array<char, 5> hex{};
  std::snprintf(hex.data(), hex.size(), "\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return hex.data();
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
}

std::string_view unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// The byte for an escape, given what follows the backslash, and how many characters it takes; 0: unknown.
std::pair<char, std::size_t> unescaped(std::string_view rest) {
  if (rest.empty()) return {'\0', 0};
  if (rest.front() == '\\') return {'\\', 1};
  if (rest.front() == 'q') return {'"', 1};
  if (rest.front() == 'n') return {'\n', 1};
  if (rest.front() == 'r') return {'\r', 1};
  unsigned byte = 0;
  if (rest.front() != 'x' || rest.size() < 3) return {'\0', 0};
  const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + 3, byte, 16);
  const bool whole = error == std::errc() && end == rest.data() + 3;
  return {static_cast<char>(byte), whole ? 3 : 0};
}

std::optional<double> read_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

struct Simple {
  std::optional<double> number;
  std::string json;
};

/// A number, TRUE or FALSE, a text, #WORD: as JSON.
Simple read_simple(std::string_view text) {
  if (text == "TRUE" || text == "FALSE") return {text == "TRUE" ? 1.0 : 0.0, text == "TRUE" ? "true" : "false"};
  if (const auto number = read_number(text)) return {number, number_text(*number)};
  return {std::nullopt, dump_json(Value{cut_utf8(krl_text(text), 4096)})};
}

struct Component {
  std::string name;
  Simple value;
};

/// "{TYPE: NAME VALUE, NAME VALUE}"; the type is optional. Nested structures are not supported.
Result<std::vector<Component>> read_structure(std::string_view text) {
  const Error broken = fail(Errc::malformed, "the robot told no KRL structure: " + std::string(text.substr(0, 80)));
  text = text.substr(1, text.size() - 2);
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) text.remove_prefix(colon + 1);
  std::vector<Component> out;
  while (!(text = trimmed(text)).empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    const std::string_view part = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t space = part.find(' ');
    if (space == std::string_view::npos || part.find('{') != std::string_view::npos) return broken;
    std::string name = cut_utf8(part.substr(0, space), 64);
    if (out.size() == kMaxComponents || std::ranges::find(out, name, &Component::name) != out.end()) return broken;
    out.push_back({std::move(name), read_simple(trimmed(part.substr(space)))});
  }
  return out;
}

KrlValue whole(const std::vector<Component>& components) {
  KrlValue out;
  for (const Component& component : components) {
    if (component.value.number) out.numbers.push_back(*component.value.number);
    out.json += (out.json.empty() ? "" : ",") + dump_json(Value{component.name}) + ":" + component.value.json;
  }
  out.json = "{" + out.json + "}";
  return out;
}

Result<KrlValue> chosen(const std::vector<Component>& components, const std::vector<std::string>& names) {
  KrlValue out;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(components, name, &Component::name);
    if (found == components.end()) {
      return fail(Errc::missing, "the robot told a structure without " + name, "correct \"values\" in commands.json");
    }
    if (found->value.number) out.numbers.push_back(*found->value.number);
    out.json += (out.json.empty() ? "" : ",") + found->value.json;
  }
  out.json = "[" + out.json + "]";
  return out;
}

}  // namespace

Result<std::string> krl_literal(const Value& value) {
  if (value.is_integer()) return std::to_string(value.integer());
  if (value.is_number()) return number_text(value.number());
  if (value.is_bool()) return std::string(value.boolean() ? "TRUE" : "FALSE");
  if (!value.is_text()) {
    return fail(Errc::bad_value, "KRL takes no " + std::string(value.kind()) + " here",
                "give a number, true or false, or a text; the items of a list by {0}, {1} …");
  }
  if (std::ranges::all_of(value.text(), is_plain)) return '"' + value.text() + '"';
  return fail(Errc::not_escapable, "KRL cannot carry a quote, a control character or non-ASCII text",
              "use plain ASCII letters, digits and signs");
}

std::string krl_field(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out += escaped(c);
  return out + '"';
}

std::vector<std::string> krl_chunks(std::string_view data, std::size_t most) {
  std::vector<std::string> chunks;
  std::string chunk;
  for (const char c : data) {
    const std::string next = escaped(c);
    if (!chunk.empty() && chunk.size() + next.size() > most) {
      chunks.push_back('"' + chunk + '"');
      chunk.clear();
    }
    chunk += next;
  }
  chunks.push_back('"' + chunk + '"');
  return chunks;
}

std::string krl_text(std::string_view field) {
  std::string_view text = unquoted(field);
  std::string out;
  while (!text.empty()) {
    const auto [byte, length] = text.front() == '\\' ? unescaped(text.substr(1)) : std::pair{'\0', std::size_t{0}};
    out += length > 0 ? byte : text.front();
    text.remove_prefix(1 + length);
  }
  return out;
}

Result<KrlValue> read_krl(std::string_view text, const std::vector<std::string>& components) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '{' && text.back() == '}') {
    const auto structure = read_structure(text);
    if (!structure) return structure.error();
    return components.empty() ? whole(*structure) : chosen(*structure, components);
  }
  if (!components.empty()) return chosen({}, components);
  Simple simple = read_simple(text);
  KrlValue out{{}, std::move(simple.json)};
  if (simple.number) out.numbers.push_back(*simple.number);
  return out;
}

std::int64_t krl_whole(std::string_view text) {
  const auto value = read_krl(text, {});
  if (!value || value->numbers.empty()) return 0;
  return static_cast<std::int64_t>(std::clamp(value->numbers.front(), -kMostWhole, kMostWhole));
}

bool krl_true(std::string_view text) {
  text = trimmed(text);
  if (text == "TRUE") return true;
  const auto number = read_number(text);
  return number && *number != 0;
}

}  // namespace trb::drivers
