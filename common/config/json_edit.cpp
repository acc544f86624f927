#include "common/config/json_edit.hpp"

#include <algorithm>
#include <vector>

namespace trb {
namespace {

constexpr std::size_t kShort = 80;
constexpr std::string_view kSpace = " \t\r\n";

/// Where a member stands in the text.
struct Place {
  std::string key;
  std::size_t begin = 0;  ///< of the key
  std::size_t value = 0;
  std::size_t end = 0;
};

std::size_t after_space(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(kSpace, at), text.size());
}

/// `at`: its first quotation mark.
std::size_t after_string(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return std::min(at + 1, text.size());
}

std::size_t after_value(std::string_view text, std::size_t at) {
  std::size_t depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '"') {
      at = after_string(text, at);
    } else if (c == '{' || c == '[') {
      ++depth;
      ++at;
    } else if (depth > 0 && (c == '}' || c == ']')) {
      --depth;
      ++at;
    } else if (depth == 0) {
      return std::min(text.find_first_of(" \t\r\n,}]", at), text.size());
    } else {
      ++at;
      continue;
    }
    if (depth == 0) return at;
  }
  return at;
}

std::string key_in(std::string_view quoted) {
  const auto key = parse_json(quoted);
  return key && key->is_text() ? key->text() : std::string();
}

std::vector<Place> places_of(std::string_view text) {
  std::vector<Place> out;
  std::size_t at = after_space(text, text.find('{') + 1);
  while (at < text.size() && text[at] == '"') {
    Place one;
    one.begin = at;
    at = after_string(text, at);
    one.key = key_in(text.substr(one.begin, at - one.begin));
    one.value = after_space(text, text.find(':', at) + 1);
    one.end = after_value(text, one.value);
    at = after_space(text, one.end);
    out.push_back(std::move(one));
    if (at < text.size() && text[at] == ',') at = after_space(text, at + 1);
  }
  return out;
}

std::string json_key(std::string_view key) {
  return dump_json(Value{std::string(key)});
}

/// The members or items between the brackets, a line each.
template <class Items, class Write>
std::string lines(const char* brackets, const Items& items, std::size_t indent, const Write& write) {
  std::string out(1, brackets[0]);
  for (const auto& item : items) {
    out += out.size() == 1 ? "\n" : ",\n";
    out += std::string(indent + 2, ' ') + write(item);
  }
  return out + "\n" + std::string(indent, ' ') + brackets[1];
}

}  // namespace

std::string with_member(std::string_view text, std::string_view key, const Value& value) {
  const std::vector<Place> places = places_of(text);
  for (const Place& one : places) {
    if (one.key != key) continue;
    return std::string(text.substr(0, one.value)) + pretty_json(value, 2) + std::string(text.substr(one.end));
  }
  const std::size_t at = places.empty() ? text.find('{') + 1 : places.back().end;
  const std::string_view rest = text.substr(at);
  return std::string(text.substr(0, at)) + (places.empty() ? "\n  " : ",\n  ") + json_key(key) + ": " +
         pretty_json(value, 2) + (rest.starts_with('}') ? "\n" : "") + std::string(rest);
}

std::string without_member(std::string_view text, std::string_view key) {
  const std::vector<Place> places = places_of(text);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].key != key) continue;
    // With the comma behind it, or, of the last one, with the comma before it.
    const bool is_last = i + 1 == places.size();
    const std::size_t begin = is_last && i > 0 ? places[i - 1].end : places[i].begin;
    const std::size_t end = is_last ? places[i].end : places[i + 1].begin;
    return std::string(text.substr(0, begin)) + std::string(text.substr(end));
  }
  return std::string(text);
}

std::string pretty_json(const Value& value, std::size_t indent) {
  std::string one_line = dump_json(value);
  if (indent + one_line.size() <= kShort) return one_line;
  if (value.is_object()) {
    return lines("{}", value.object(), indent, [&](const auto& member) {
      return json_key(member.first) + ": " + pretty_json(member.second, indent + 2);
    });
  }
  if (!value.is_list()) return one_line;
  return lines("[]", value.list(), indent, [&](const Value& item) { return pretty_json(item, indent + 2); });
}

}  // namespace trb
