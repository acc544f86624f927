#include "common/drivers/tcp-dialogue/syntax.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/number_text.hpp"
#include "common/drivers/text/next_word.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kQuestion = R"(write LINE -> PATTERN, for example "GetAngle() -> 0,{{0},{1}},*")";
constexpr std::string_view kArrow = " -> ";
constexpr std::string_view kElse = " else ";
constexpr std::string_view kWhere = " where ";
constexpr std::size_t kMostEnd = 32;
constexpr std::size_t kMostLines = 16;
constexpr std::size_t kMostNumbers = 32;
constexpr std::size_t kMostWritten = 65536;

bool is_control(char c) {
  return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
}

std::string quoted(std::string_view text) {
  return "'" + std::string(text.substr(0, 60)) + "'";
}

/// The robot must see one line, and where it ends.
bool ends_once(const std::string& line, const std::string& line_end) {
  return line_end.empty() || (line + line_end).find(line_end) == line.size();
}

Status check_words(std::string_view words, const std::string& line_end) {
  if (words.empty()) return fail(Errc::bad_value, "a line without words", "write the robot's words");
  if (std::ranges::any_of(words, is_control))
    return fail(Errc::bad_value, quoted(words) + " has a control character", "leave it out; line_end ends each line");
  if (!ends_once(std::string(words), line_end))
    return fail(Errc::bad_value, quoted(words) + " has line_end in it", "leave it out: it is sent after the line");
  return Done{};
}

Error no_text(const Value& value) {
  return fail(Errc::bad_value, "a " + std::string(value.kind()) + " has no words here",
              "give a number, true, false or a \"text\", or a list of them for {0}, {1} …");
}

Result<std::string> plain_literal(const Value& value) {
  if (value.is_number()) return value.is_integer() ? std::to_string(value.integer()) : number_text(value.number());
  if (value.is_bool()) return std::string(value.boolean() ? "true" : "false");
  if (!value.is_text()) return no_text(value);
  const auto ends_text = [](char c) { return is_control(c) || c == '"' || c == '\'' || c == '\\'; };
  if (std::ranges::any_of(value.text(), ends_text)) {
    return fail(Errc::not_escapable, "the data has a control character, a quote or a backslash",
                "send one line of text without them");
  }
  return value.text();
}

bool is_word_byte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '+' || c == '-' ||
         c == '.' || c == '_';
}

/// Where nothing ends a line, a bracket or a comma in the data would begin another command.
Result<std::string> word_literal(const Value& value) {
  auto text = plain_literal(value);
  if (text && !std::ranges::all_of(*text, is_word_byte)) {
    return fail(Errc::not_escapable, quoted(*text) + " may not be filled in: no line_end keeps it from being a command",
                "send numbers, or words of letters, digits and + - . _");
  }
  return text;
}

Result<DialogueLine> read_line(std::string_view text, const std::string& line_end) {
  std::optional<Pattern> end;
  std::optional<Pattern> failure;
  if (const std::size_t arrow = text.rfind(kArrow); arrow != std::string_view::npos) {
    std::string_view rest = text.substr(arrow + kArrow.size());
    text = text.substr(0, arrow);
    if (const std::size_t other = rest.find(kElse); other != std::string_view::npos) {
      auto pattern = Pattern::read(rest.substr(other + kElse.size()));
      if (!pattern) return pattern.error();
      failure = std::move(*pattern);
      rest = rest.substr(0, other);
    }
    auto pattern = Pattern::read(rest);
    if (!pattern) return pattern.error();
    end = std::move(*pattern);
  }
  for (const auto* pattern : {&end, &failure}) {
    if (*pattern && (!(*pattern)->has_literal() || (*pattern)->holes() > 0))
      return fail(Errc::bad_value, quoted((*pattern)->text()) + " is no end of a command",
                  "write the words of the line that ends it, with * for the rest and without {0}");
  }
  if (Status good = check_words(text, line_end); !good) return good.error();
  return DialogueLine{std::string(text), VendorTemplate(text), std::move(end), std::move(failure)};
}

/// "TEXT=NUMBER ..."
Status read_numbers(std::string_view text, DialogueQuestion& into) {
  while (!text.empty()) {
    const std::string_view word = next_word(text);
    const std::size_t equals = word.rfind('=');
    const auto number = equals == std::string_view::npos ? std::nullopt : parse_number<double>(word.substr(equals + 1));
    if (!number || equals == 0 || !std::isfinite(*number))
      return fail(Errc::bad_value, quoted(word) + " is no TEXT=NUMBER", "write where STOPPED=0 PLAYING=1");
    into.numbers[std::string(word.substr(0, equals))] = *number;
  }
  if (into.numbers.empty() || into.numbers.size() > kMostNumbers)
    return fail(Errc::bad_value, "has " + std::to_string(into.numbers.size()) + " texts after \"where\"",
                "write 1 to 32 of TEXT=NUMBER, or leave \"where\" out");
  return Done{};
}

}  // namespace

Result<std::string> read_text_end(std::string_view text) {
  if (text == "lf") return std::string("\n");
  if (text == "crlf") return std::string("\r\n");
  if (text == "cr") return std::string("\r");
  if (text == "nul") return std::string(1, '\0');
  if (text.size() > kMostEnd)
    return fail(Errc::bad_value, "has " + std::to_string(text.size()) + " bytes",
                "use lf, crlf, cr, nul or a text of at most 32 bytes");
  return std::string(text);
}

Result<std::vector<DialogueLine>> read_dialogue_lines(std::string_view text, const std::string& line_end) {
  std::vector<DialogueLine> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    if (!out.empty() && out.back().end)
      return fail(Errc::bad_value, "a line after " + quoted(out.back().text) + ", which ends the command later",
                  "let only the last line have ->");
    auto one = read_line(line, line_end);
    if (!one) return one.error();
    out.push_back(std::move(*one));
  }
  if (out.size() > kMostLines) return fail(Errc::bad_value, "more than 16 lines", "use fewer");
  return out;
}

Result<std::string> read_fixed_line(std::string_view text, const std::string& line_end) {
  if (Status good = check_words(text, line_end); !good) return good.error();
  if (!VendorTemplate(text).fill("", json_literal))
    return fail(Errc::bad_value, quoted(text) + " needs data, and there is none here", "write the words themselves");
  return std::string(text);
}

Result<DialogueQuestion> read_dialogue_question(std::string_view text, const std::string& line_end) {
  const std::size_t arrow = text.rfind(kArrow);
  if (arrow == std::string_view::npos) return fail(Errc::bad_value, "says not what its answer looks like", kQuestion);
  auto line = read_fixed_line(text.substr(0, arrow), line_end);
  if (!line) return line.error();
  std::string_view rest = text.substr(arrow + kArrow.size());
  const std::size_t where = rest.find(kWhere);
  auto pattern = Pattern::read(rest.substr(0, where));
  if (!pattern) return pattern.error();
  if (pattern->holes() == 0) {
    return fail(Errc::bad_value, "the pattern " + quoted(pattern->text()) + " takes nothing from the answer",
                "write {0} where the value is");
  }
  DialogueQuestion out{std::move(*line), std::move(*pattern), {}};
  if (where == std::string_view::npos) return out;
  if (Status read = read_numbers(rest.substr(where + kWhere.size()), out); !read) return read.error();
  return out;
}

Result<std::string> fill_dialogue_line(const DialogueLine& line, BytesView data, const std::string& line_end) {
  auto out = line.words.fill(data, line_end.empty() ? word_literal : plain_literal);
  if (!out) return out;
  if (out->size() > kMostWritten) return fail(Errc::bad_value, "a line over 64 KiB", "send less data");
  if (!ends_once(*out, line_end))
    return fail(Errc::not_escapable, "the data has line_end in it, which would end the robot's command",
                "send one line of text");
  return out;
}

Value value_of_text(std::string_view text) {
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  if (const auto whole = parse_number<std::int64_t>(digits)) return Value{*whole};
  if (const auto number = parse_number<double>(digits); number && std::isfinite(*number)) return Value{*number};
  return Value{std::string(text)};
}

}  // namespace trb::drivers
