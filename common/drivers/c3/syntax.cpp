#include "common/drivers/c3/syntax.hpp"

#include <algorithm>
#include <array>

#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxName = 24;  ///< of a KRL name
constexpr std::size_t kMaxVariable = 128;
constexpr std::size_t kMaxAssignments = 32;
constexpr std::size_t kMaxAsked = 32;
constexpr std::string_view kPrefix = "trb_";

struct Role {
  std::string_view name;
  std::string C3Names::*variable;
  std::string_view preset;
};

constexpr std::array<Role, 21> kRoles{{
    {"trb_type", &C3Names::type, "TRB_TYPE[]"},
    {"trb_subtype", &C3Names::subtype, "TRB_SUBTYPE[]"},
    {"trb_source", &C3Names::source, "TRB_SOURCE[]"},
    {"trb_size", &C3Names::size, "TRB_SIZE"},
    {"trb_data", &C3Names::data, "TRB_DATA[]"},
    {"trb_chunk", &C3Names::chunk, "TRB_CHUNK"},
    {"trb_number", &C3Names::number, "TRB_NUMBER"},
    {"trb_command", &C3Names::command, "TRB_COMMAND"},
    {"trb_done", &C3Names::done, "TRB_DONE"},
    {"trb_done_number", &C3Names::done_number, "TRB_DONE_NUMBER"},
    {"trb_result", &C3Names::result, "TRB_RESULT"},
    {"trb_text", &C3Names::text, "TRB_TEXT[]"},
    {"trb_out", &C3Names::out, "TRB_OUT"},
    {"trb_out_type", &C3Names::out_type, "TRB_OUT_TYPE[]"},
    {"trb_out_subtype", &C3Names::out_subtype, "TRB_OUT_SUBTYPE[]"},
    {"trb_out_target", &C3Names::out_target, "TRB_OUT_TARGET[]"},
    {"trb_out_size", &C3Names::out_size, "TRB_OUT_SIZE"},
    {"trb_out_data", &C3Names::out_data, "TRB_OUT_DATA[]"},
    {"trb_stopped", &C3Names::stopped, "TRB_STOPPED"},
    {"trb_stop_message", &C3Names::stop_message, "$STOPMESS"},
    {"trb_error", &C3Names::error, "TRB_ERROR[]"},
}};

std::string_view trimmed_line(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(" \t\r") + 1);
}

std::string_view take(std::string_view& text, char end) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view piece = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return piece;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// A name of KRL: a letter, then letters and digits; system variables begin with $.
bool is_name(std::string_view text) {
  if (text.starts_with('$')) text.remove_prefix(1);
  return !text.empty() && text.size() <= kMaxName && is_letter(text.front()) &&
         std::ranges::all_of(text, [](char c) { return is_letter(c) || is_digit(c); });
}

/// Nothing, [] (all of it), or [n].
bool is_index(std::string_view text) {
  if (text.empty()) return true;
  return text.size() <= 8 && text.front() == '[' && text.back() == ']' &&
         std::ranges::all_of(text.substr(1, text.size() - 2), is_digit);
}

/// Names with or without an index, joined by dots.
bool is_variable(std::string_view text) {
  if (text.empty() || text.size() > kMaxVariable || text.ends_with('.')) return false;
  while (!text.empty()) {
    const std::string_view part = take(text, '.');
    const std::size_t bracket = std::min(part.find('['), part.size());
    if (!is_name(part.substr(0, bracket)) || !is_index(part.substr(bracket))) return false;
  }
  return true;
}

Error no_variable(std::string_view text) {
  return fail(Errc::bad_value, in_quotes(text) + " is no variable of KRL",
              "write a name of at most 24 letters, digits and _, such as TRB_STOP, TRB_TEXT[], $POS_ACT.X");
}

/// The end of the placeholder that begins here; npos: there is none.
std::size_t placeholder_end(std::string_view text) {
  const std::size_t end = text.starts_with('{') ? text.find('}') : std::string_view::npos;
  if (end == std::string_view::npos) return end;
  const std::string_view inside = text.substr(1, end - 1);
  const bool number = !inside.empty() && inside.size() <= 2 && std::ranges::all_of(inside, is_digit);
  return number || inside == "data" ? end : std::string_view::npos;
}

/// The value with 0 for each placeholder; a placeholder within quotes is a mistake: its text would end them.
Result<std::string> filled(std::string_view value) {
  std::string out;
  bool quoted = false;
  while (!value.empty()) {
    const std::size_t end = placeholder_end(value);
    if (end != std::string_view::npos) {
      if (quoted) return fail(Errc::bad_value, "a placeholder stands within quotes", "leave the quotes out");
      out += '0';
      value.remove_prefix(end + 1);
      continue;
    }
    if (value.front() == '"') quoted = !quoted;
    out += value.front();
    value.remove_prefix(1);
  }
  return out;
}

/// One value: letters, digits, signs and quoted texts; a structure in its own brackets.
bool is_krl_value(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c < ' ' || c > '~') return false;
    if (c == '"') quoted = !quoted;
    if (quoted || c == '"') continue;
    if (c == '{') ++depth;
    if (c == '}' && --depth < 0) return false;
    const bool in_structure = depth > 0 && (c == ' ' || c == ',' || c == ':');
    const bool plain = is_letter(c) || is_digit(c) || std::string_view("+-.#{}[]$'").find(c) != std::string_view::npos;
    if (!plain && !in_structure) return false;
  }
  return !text.empty() && depth == 0 && !quoted;
}

Result<C3Assignment> read_assignment(std::string_view line) {
  std::string_view rest = line;
  C3Assignment out{std::string(trimmed_line(take(rest, '='))), std::string(trimmed_line(rest))};
  if (!is_variable(out.variable)) return no_variable(out.variable);
  const auto value = filled(out.value);
  if (!value) return fail(Errc::bad_value, out.variable + ": " + value.error().what, value.error().hint);
  if (is_krl_value(*value)) return out;
  return fail(
      Errc::bad_value, in_quotes(out.value) + " is no value of KRL for " + out.variable,
      "write VARIABLE = VALUE, such as TRB_STOP = TRUE, TRB_TOOL[] = \"grip\", TRB_POS = {E6POS: X {0}, Y {1}}");
}

}  // namespace

Result<std::vector<C3Assignment>> read_c3_assignments(std::string_view text) {
  std::vector<C3Assignment> out;
  while (!text.empty()) {
    const std::string_view line = trimmed_line(take(text, '\n'));
    if (line.empty()) continue;
    auto assignment = read_assignment(line);
    if (!assignment) return assignment.error();
    out.push_back(std::move(*assignment));
  }
  if (out.size() > kMaxAssignments) return fail(Errc::bad_value, "more than 32 assignments", "write fewer");
  return out;
}

Result<C3Question> read_c3_question(std::string_view text) {
  text = trimmed_line(text);
  C3Question out{std::string(take(text, ' ')), {}};
  if (!is_variable(out.variable)) return no_variable(out.variable);
  while (!(text = trimmed_line(text)).empty()) {
    const std::string_view component = take(text, ' ');
    if (!is_name(component)) {
      return fail(Errc::bad_value, in_quotes(component) + " is no component of a structure",
                  "write \"VARIABLE COMPONENT ...\", for example \"$POS_ACT X Y Z\"");
    }
    out.components.emplace_back(component);
  }
  if (out.components.size() > kMaxAsked) return fail(Errc::bad_value, "more than 32 components", "ask for fewer");
  return out;
}

bool is_c3_name(std::string_view name) {
  return name.starts_with(kPrefix);
}

Result<C3Names> read_c3_names(const std::map<std::string, std::string>& values, bool fields) {
  C3Names names;
  if (fields) {
    for (const Role& role : kRoles) names.*role.variable = role.preset;
  }
  for (const auto& [name, variable] : values) {
    if (!is_c3_name(name)) continue;
    const auto* const role = std::ranges::find(kRoles, name, &Role::name);
    if (role == kRoles.end()) {
      std::vector<std::string> known;
      known.reserve(kRoles.size());
      for (const Role& each : kRoles) known.emplace_back(each.name);
      return fail(Errc::unknown_key, in_quotes(name) + " is no part of the hand-shake",
                  did_you_mean(name, known, "use one of"));
    }
    names.*role->variable = variable;
  }
  return names;
}

}  // namespace trb::drivers
