#include "services/virtual-robots/ur/tokens.hpp"

#include <string_view>

namespace trb::virtual_robots::ur {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/** Length of the name, number or string at the front; 0 if it has no end. */
std::size_t name_length(std::string_view rest) {
  std::size_t length = 1;
  while (length < rest.size() && (is_letter(rest[length]) || is_digit(rest[length]))) ++length;
  return length;
}

std::size_t number_length(std::string_view rest) {
  std::size_t length = 0;
  while (length < rest.size()) {
    const char c = rest[length];
    const bool exponent_sign = (c == '-' || c == '+') && length > 0 && (rest[length - 1] | 0x20) == 'e';
    if (!is_digit(c) && c != '.' && (c | 0x20) != 'e' && !exponent_sign) break;
    ++length;
  }
  return length;
}

std::size_t text_length(std::string_view rest) {
  const std::size_t end = rest.find('"', 1);
  return end == std::string_view::npos ? 0 : end + 1;
}

std::size_t symbol_length(std::string_view rest) {
  for (const std::string_view pair : {"==", "!=", "<=", ">="}) {
    if (rest.starts_with(pair)) return pair.size();
  }
  return std::string_view("()[],=:+-*/%<>").find(rest.front()) == std::string_view::npos ? 0 : 1;
}

Token next_token(std::string_view rest, std::size_t& length) {
  const char first = rest.front();
  const bool number = is_digit(first) || (first == '.' && rest.size() > 1 && is_digit(rest[1]));
  Token token;
  if (is_letter(first)) {
    token.kind = Token::Kind::name;
    length = name_length(rest);
  } else if (number) {
    token.kind = Token::Kind::number;
    length = number_length(rest);
  } else if (first == '"') {
    token.kind = Token::Kind::text;
    length = text_length(rest);
  } else {
    token.kind = Token::Kind::symbol;
    length = symbol_length(rest);
  }
  token.text = std::string(rest.substr(0, length));
  return token;
}

}  // namespace

std::vector<Token> tokenize(const ScriptLine& line) {
  std::vector<Token> tokens;
  std::size_t at = 0;
  while (at < line.text.size() && line.text[at] != '#') {
    const bool blank = line.text[at] == ' ' || line.text[at] == '\t' || line.text[at] == '\r';
    std::size_t length = 1;
    if (!blank) {
      Token token = next_token(line.text.substr(at), length);
      token.column = static_cast<int>(at) + 1;
      if (length == 0) fail_syntax(line, token.column);
      tokens.push_back(std::move(token));
    }
    at += length;
  }
  tokens.push_back({Token::Kind::end, "", static_cast<int>(at) + 1});
  return tokens;
}

}  // namespace trb::virtual_robots::ur
