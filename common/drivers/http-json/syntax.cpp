#include "common/drivers/http-json/syntax.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "common/drivers/text/next_word.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr const char* kQuestion = "write \"GET PATH POINTER ...\", for example \"GET /status /battery_percentage\"";
constexpr std::size_t kMaxPath = 1024;
constexpr std::size_t kMaxPointer = 256;
constexpr std::size_t kMaxParts = 16;
constexpr std::size_t kMaxNumbers = 32;
constexpr std::array<std::string_view, 5> kMethods{"GET", "POST", "PUT", "PATCH", "DELETE"};

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= 32 &&
         std::ranges::all_of(text, [](char c) { return is_letter_or_digit(c) || c == '_'; });
}

bool is_pointer(std::string_view text) {
  return text.size() <= kMaxPointer && (text.empty() || text.front() == '/');
}

std::string escaped(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    if (is_letter_or_digit(c) || c == '-' || c == '_' || c == '.' || c == '~') {
      out += c;
    } else {
      out += '%';
      out += kDigits[static_cast<unsigned char>(c) >> 4U];
      out += kDigits[static_cast<unsigned char>(c) & 15U];
    }
  }
  return out;
}

/// A number, true or false, or a text. Errors: bad_value.
Result<std::string> plain_text(const Value& value) {
  if (value.is_text()) return value.text();
  if (value.is_number()) return value.is_integer() ? std::to_string(value.integer()) : number_text(value.number());
  if (value.is_bool()) return std::string(value.boolean() ? "true" : "false");
  return fail(Errc::bad_value, "a list or an object stands where one value belongs",
              "give a number, true or false, or a \"text\"");
}

Result<std::string> form_literal(const Value& value) {
  const auto text = plain_text(value);
  return text ? Result<std::string>(escaped(*text)) : text;
}

/// A server may take %2F for /, and an empty part, "." and ".." for other paths.
Result<std::string> path_literal(const Value& value) {
  const auto text = plain_text(value);
  if (!text) return text;
  if (text->empty() || *text == "." || *text == ".." || text->find_first_of("/\\") != std::string::npos) {
    return fail(Errc::not_escapable, "'" + text->substr(0, 60) + "' would lead to another path",
                "give a name or a number: no /, not \".\" or \"..\", and not an empty text");
  }
  return escaped(*text);
}

bool is_hole(std::string_view inside) {
  return inside == "data" ||
         (!inside.empty() && inside.size() <= 2 && inside.find_first_not_of("0123456789") == std::string_view::npos);
}

/// Removes "-> NAME POINTER" from the end of the line.
Status take_memory(std::string_view& line, HttpCall& words) {
  constexpr std::string_view kArrow = " -> ";
  const std::size_t at = line.rfind(kArrow);
  // Not an arrow inside a text of the body.
  if (at == std::string_view::npos || line.find_first_of("\"}", at) != std::string_view::npos) return Done{};
  std::string_view rest = line.substr(at + kArrow.size());
  words.remembers = next_word(rest);
  words.pointer = next_word(rest);
  if (!is_name(words.remembers) || !is_pointer(words.pointer) || words.pointer.empty() || !rest.empty()) {
    return fail(Errc::bad_value, "'" + std::string(line.substr(at + 1, 60)) + "' names nothing to keep",
                "write it as -> mission /id: a name, and where the answer says it");
  }
  line = line.substr(0, at);
  return Done{};
}

/// "NAME=VALUE&NAME=VALUE".
Status check_form(std::string_view form) {
  constexpr std::string_view kOthers = "-._~*+%=&{}[]!$'(),:;@/?";
  const auto fits = [&](char c) { return is_letter_or_digit(c) || kOthers.find(c) != std::string_view::npos; };
  const auto bad = std::ranges::find_if_not(form, fits);
  if (bad != form.end()) {
    return fail(Errc::bad_value, "the body: '" + std::string(1, *bad) + "' may not stand in a form",
                "write it as %XX, and the form as NAME=VALUE&NAME=VALUE");
  }
  if (form.find('=') != std::string_view::npos) return Done{};
  return fail(Errc::bad_value, "the body: '" + std::string(form.substr(0, 60)) + "' is no form",
              "write it as NAME=VALUE&NAME=VALUE");
}

/// A body that is valid JSON whatever is filled in.
Status check_json(const VendorTemplate& body) {
  std::string zeros = "[0";
  for (std::size_t i = 1; i < std::max<std::size_t>(body.items(), 1); ++i) zeros += ",0";
  const auto filled = body.fill(zeros + "]", json_literal);
  const auto json = filled ? parse_json(*filled) : Result<Value>(filled.error());
  if (!json) return fail(Errc::bad_value, "the body: " + json.error().what, json.error().hint);
  return Done{};
}

Result<HttpCall> read_line(std::string_view line, HttpBody body) {
  constexpr std::string_view kAlways = "always ";
  HttpCall words;
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  words.always = line.starts_with(kAlways);
  if (words.always) line.remove_prefix(kAlways.size());
  if (Status kept = take_memory(line, words); !kept) return kept.error();
  words.method = next_word(line);
  if (std::ranges::find(kMethods, words.method) == kMethods.end()) {
    return fail(Errc::bad_value, "'" + words.method.substr(0, 20) + "' is no method",
                "use GET, POST, PUT, PATCH or DELETE");
  }
  auto path = HttpPath::read(next_word(line));
  if (!path) return path.error();
  words.path = std::move(*path);
  if (line.empty()) return words;
  words.body = VendorTemplate(line);
  if (Status good = body == HttpBody::json ? check_json(*words.body) : check_form(line); !good) return good.error();
  return words;
}

/// "TEXT=NUMBER", for the pointer before it.
Status read_number_of_text(std::string_view word, std::vector<HttpQuestion::Part>& parts) {
  const std::size_t equals = word.find('=');
  double number = 0;
  const char* const end = word.data() + word.size();
  const char* const begin = equals == std::string_view::npos ? end : word.data() + equals + 1;
  const auto read = std::from_chars(begin, end, number);
  if (parts.empty() || parts.back().is_number || equals == 0 || begin == end || read.ec != std::errc() ||
      read.ptr != end) {
    return fail(
        Errc::bad_value,
        "'" + std::string(word.substr(0, 60)) + "' is neither a pointer, nor \"number\" or TEXT=NUMBER behind one",
        kQuestion);
  }
  auto& numbers = parts.back().numbers;
  numbers[std::string(word.substr(0, equals))] = number;
  if (numbers.size() > kMaxNumbers) return fail(Errc::bad_value, "more than 32 texts", "name fewer");
  return Done{};
}

}  // namespace

Result<HttpPath> HttpPath::read(std::string_view text) {
  const auto bad = [&](const std::string& what, const std::string& hint) {
    return fail(Errc::bad_value, "'" + std::string(text.substr(0, 60)) + "' " + what, hint);
  };
  if (text.empty() || text.front() != '/') return bad("is no path", "begin it with /, for example /api/v2.0.0/status");
  if (text.size() > kMaxPath) return bad("is too long", "use at most 1024 characters");
  HttpPath out;
  out.text_ = text;
  constexpr std::string_view kOthers = "-._~!$&'()*+,;=:@/?%";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '<') {
      const std::size_t end = text.find('>', i);
      if (end == std::string_view::npos || !is_name(text.substr(i + 1, end - i - 1)))
        return bad("has a < without a name and >", "write it as <mission>");
      i = end;
    } else if (text[i] == '{') {
      const std::size_t end = text.find('}', i);
      if (end == std::string_view::npos || !is_hole(text.substr(i + 1, end - i - 1)))
        return bad("has a { that is no placeholder", "write it as {0} or {data}");
      i = end;
    } else if (!is_letter_or_digit(text[i]) && kOthers.find(text[i]) == std::string_view::npos) {
      return bad("has a character that no path may have", "write it as %XX");
    }
  }
  return out;
}

Result<HttpPath> HttpPath::with(BytesView data) const {
  if (!needs_data()) return *this;
  auto filled = VendorTemplate(text_).fill(data, path_literal);
  if (!filled) return filled.error();
  HttpPath out;
  out.text_ = std::move(*filled);
  return out;
}

std::vector<std::string> HttpPath::names() const {
  std::vector<std::string> out;
  for (std::size_t i = text_.find('<'); i != std::string::npos; i = text_.find('<', i + 1))
    out.push_back(text_.substr(i + 1, text_.find('>', i) - i - 1));
  return out;
}

Result<std::string> HttpPath::fill(const Remembered& known) const {
  std::string out;
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] != '<') {
      out += text_[i];
      continue;
    }
    const std::size_t end = text_.find('>', i);
    const std::string name = text_.substr(i + 1, end - i - 1);
    const auto at = known.find(name);
    if (at == known.end()) {
      return fail(Errc::missing, "no answer has told '" + name + "' yet",
                  "it is told by a command that ends with -> " + name);
    }
    out += escaped(at->second);
    i = end;
  }
  return out;
}

Literal http_literal(HttpBody body) {
  return body == HttpBody::json ? json_literal : form_literal;
}

Result<std::vector<HttpCall>> read_http_calls(std::string_view text, HttpBody body) {
  std::vector<HttpCall> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    auto words = read_line(line, body);
    if (!words) return words.error();
    out.push_back(std::move(*words));
  }
  return out;
}

Result<HttpQuestion> read_http_question(std::string_view text) {
  HttpQuestion question;
  if (next_word(text) != "GET") return fail(Errc::bad_value, "a value is read with GET", kQuestion);
  auto path = HttpPath::read(next_word(text));
  if (!path) return path.error();
  question.path = std::move(*path);
  while (!text.empty()) {
    const std::string_view word = next_word(text);
    if (is_pointer(word)) {
      question.parts.push_back({std::string(word)});
    } else if (word == "number" && !question.parts.empty() && question.parts.back().numbers.empty()) {
      question.parts.back().is_number = true;
    } else if (const Status read = read_number_of_text(word, question.parts); !read) {
      return read.error();
    }
  }
  if (question.parts.empty()) return fail(Errc::bad_value, "says not where in the answer the value is", kQuestion);
  if (question.parts.size() > kMaxParts) return fail(Errc::bad_value, "more than 16 pointers", "ask for fewer");
  return question;
}

const Value* find_by_pointer(const Value& json, std::string_view pointer) {
  const Value* at = &json;
  while (!pointer.empty() && at != nullptr) {
    pointer.remove_prefix(1);  // the /
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    std::string key;
    for (std::size_t i = 0; i < end; ++i) {
      const bool escape = pointer[i] == '~' && i + 1 < end && (pointer[i + 1] == '0' || pointer[i + 1] == '1');
      key += escape ? (pointer[i + 1] == '0' ? '~' : '/') : pointer[i];
      i += escape ? 1 : 0;
    }
    pointer.remove_prefix(end);
    if (at->is_list()) {
      std::size_t index = 0;
      const auto read = std::from_chars(key.data(), key.data() + key.size(), index);
      const bool is_index = read.ec == std::errc() && read.ptr == key.data() + key.size();
      at = is_index && index < at->list().size() ? &at->list()[index] : nullptr;
    } else {
      at = at->find(key);
    }
  }
  return at;
}

}  // namespace trb::drivers
