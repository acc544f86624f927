#include "common/drivers/tcp-text/urscript.hpp"

#include <algorithm>
#include <array>

#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr std::array<std::string_view, 5> kInterfaceCommands = {"power on", "power off", "set robotmode run",
                                                                "stop program", "set unlock protective stop"};

bool is_plain(char c) {
  return c >= ' ' && c <= '~' && c != '"' && c != '\\';
}

Error no_literal(const Value& value) {
  return fail(Errc::bad_value, "URScript takes no " + std::string(value.kind()) + " here",
              "give a number, true or false, a text, or a list of numbers");
}

std::string number_literal(const Value& value) {
  return value.is_integer() ? std::to_string(value.integer()) : number_text(value.number());
}

Result<std::string> text_literal(const std::string& text) {
  if (std::all_of(text.begin(), text.end(), is_plain)) return '"' + text + '"';
  return fail(Errc::not_escapable, "URScript cannot carry a quote, a backslash, a control character or non-ASCII text",
              "use plain ASCII letters, digits and signs");
}

Result<std::string> list_literal(const Value::List& list) {
  std::string out = "[";
  for (const Value& item : list) {
    if (!item.is_number()) return no_literal(item);
    if (out.size() > 1) out += ", ";
    out += number_literal(item);
  }
  return out + "]";
}

}  // namespace

Result<std::string> urscript_literal(const Value& value) {
  if (value.is_number()) return number_literal(value);
  if (value.is_bool()) return std::string(value.boolean() ? "True" : "False");
  if (value.is_text()) return text_literal(value.text());
  if (value.is_list()) return list_literal(value.list());
  return no_literal(value);
}

std::string urscript_program(std::string_view name, std::string_view lines) {
  std::string out = "def " + std::string(name) + "():\n";
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    out.append("  ").append(lines.substr(0, end)).append("\n");
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
  return out + "  textmsg(\"" + urscript_end_text(name) + "\")\nend\n";
}

std::string urscript_end_text(std::string_view name) {
  return std::string(name) + " done";
}

bool is_interface_command(std::string_view text) {
  return std::find(kInterfaceCommands.begin(), kInterfaceCommands.end(), text) != kInterfaceCommands.end();
}

bool may_be_urscript(std::string_view text) {
  return is_interface_command(text) || text == "halt" || text.find('(') != std::string_view::npos;
}

}  // namespace trb::drivers
