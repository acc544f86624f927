#include "services/virtual-robots/kuka/variables.hpp"

#include <algorithm>
#include <cctype>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::kuka {
namespace {

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::toupper(c); });
  return out;
}

bool is_structure(Type type) {
  return type == Type::axis || type == Type::pos;
}

/** The contents of a quoted text of printable characters. */
std::optional<std::string> quoted(std::string_view text) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return std::nullopt;
  text = text.substr(1, text.size() - 2);
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~' && c != '"'; });
  return plain ? std::optional<std::string>(text) : std::nullopt;
}

/** Sets the components that the text names. */
bool set_parts(Type type, std::string_view text, std::vector<double>& parts) {
  if (text.size() < 2 || text.front() != '{' || text.back() != '}') return false;
  text = text.substr(1, text.size() - 2);
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const std::string name = upper(trim(text.substr(0, colon)));
    const bool axis = name == "E6AXIS" || name == "AXIS";
    if (type == Type::axis ? !axis : name != "E6POS" && name != "POS" && name != "FRAME") return false;
    text.remove_prefix(colon + 1);
  }
  const std::vector<std::string>& names = components_of(type);
  std::vector<double> changed = parts;
  for (const std::string& piece : split(text, ',')) {
    std::string_view rest = trim(piece);
    const auto found = std::find(names.begin(), names.end(), upper(take_word(rest)));
    const auto number = parse_number(trim(rest));
    if (found == names.end() || !number) return false;
    changed[static_cast<std::size_t>(found - names.begin())] = *number;
  }
  parts = changed;
  return true;
}

}  // namespace

const std::vector<std::string>& components_of(Type type) {
  static const std::vector<std::string> axis = {"A1", "A2", "A3", "A4", "A5", "A6", "E1", "E2", "E3", "E4", "E5", "E6"};
  static const std::vector<std::string> pos = {"X", "Y",  "Z",  "A",  "B",  "C",  "S",
                                               "T", "E1", "E2", "E3", "E4", "E5", "E6"};
  return type == Type::axis ? axis : pos;
}

std::string structure_text(Type type, const std::vector<double>& parts) {
  const std::vector<std::string>& names = components_of(type);
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool whole = names[i] == "S" || names[i] == "T";
    const double part = i < parts.size() ? parts[i] : 0;
    out += (i == 0 ? "" : ", ") + names[i] + " " + format_fixed(part, whole ? 0 : 4);
  }
  return std::string(type == Type::axis ? "{E6AXIS: " : "{E6POS: ") + out + "}";
}

void Variables::declare(const std::string& name, Type type, const std::string& value, std::size_t room) {
  Variable variable;
  variable.type = type;
  variable.room = room;
  if (is_structure(type)) {
    variable.parts.assign(components_of(type).size(), 0);
    set_parts(type, value, variable.parts);
  } else {
    variable.value = value;
  }
  variables_[name] = std::move(variable);
}

void Variables::declare_live(const std::string& name, std::function<std::string()> value) {
  variables_[name].live = std::move(value);
}

/** Texts are arrays and are named with []; a structure's component follows a dot. */
std::string Variables::key_of(std::string_view name, std::string& component) const {
  std::string wanted = upper(trim(name));
  const bool array = wanted.ends_with("[]");
  if (array) wanted.resize(wanted.size() - 2);
  if (const std::size_t dot = wanted.find('.'); dot != std::string::npos) {
    component = wanted.substr(dot + 1);
    wanted.resize(dot);
  }
  const auto found = variables_.find(wanted);
  if (found == variables_.end()) return {};
  const bool is_text = !found->second.live && found->second.type == Type::text;
  return array == is_text ? wanted : std::string();
}

std::optional<std::string> Variables::read(std::string_view name) const {
  std::string component;
  const std::string key = key_of(name, component);
  if (key.empty()) return std::nullopt;
  const Variable& found = variables_.at(key);
  std::string value = found.live ? found.live() : found.value;
  if (!found.live && is_structure(found.type)) value = structure_text(found.type, found.parts);
  if (component.empty()) return found.type == Type::text && !found.live ? '"' + value + '"' : value;
  const std::size_t at = value.find(" " + component + " ");
  if (value.empty() || value.front() != '{' || at == std::string::npos) return std::nullopt;
  const std::size_t begin = at + component.size() + 2;
  return value.substr(begin, value.find_first_of(",}", begin) - begin);
}

bool Variables::write(std::string_view name, std::string_view value) {
  std::string component;
  const std::string key = key_of(name, component);
  if (key.empty() || variables_.at(key).live) return false;
  Variable& found = variables_.at(key);
  value = trim(value);
  if (!component.empty()) {
    return is_structure(found.type) &&
           set_parts(found.type, "{" + component + " " + std::string(value) + "}", found.parts);
  }
  switch (found.type) {
    case Type::axis:
    case Type::pos:
      return set_parts(found.type, value, found.parts);
    case Type::text: {
      const auto text = quoted(value);
      if (!text || text->size() > found.room) return false;
      found.value = *text;
      return true;
    }
    case Type::bool_:
      if (upper(value) != "TRUE" && upper(value) != "FALSE") return false;
      break;
    case Type::int_:
      if (!parse_integer(value)) return false;
      break;
    case Type::real:
      if (!parse_number(value)) return false;
      break;
    case Type::enum_:
      if (!value.starts_with('#')) return false;
      break;
  }
  found.value = upper(value);
  return true;
}

long long Variables::number(const std::string& name) const {
  return parse_integer(text(name)).value_or(0);
}

std::string Variables::text(const std::string& name) const {
  return variables_.at(name).value;
}

std::vector<double> Variables::numbers(const std::string& name) const {
  return variables_.at(name).parts;
}

void Variables::set(const std::string& name, const std::string& value) {
  Variable& variable = variables_.at(name);
  variable.value = variable.type == Type::text ? value.substr(0, variable.room) : value;
}

std::size_t Variables::room(const std::string& name) const {
  return variables_.at(name).room;
}

}  // namespace trb::virtual_robots::kuka
