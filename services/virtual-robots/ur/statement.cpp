#include "services/virtual-robots/ur/statement.hpp"

#include <algorithm>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

Value parse_value(Cursor& cursor, const Variables& variables);

double parse_signed_number(Cursor& cursor) {
  const bool minus = cursor.take_symbol('-');
  if (!minus) cursor.take_symbol('+');
  if (cursor.peek().kind != Token::Kind::Number) cursor.fail();
  const auto number = parse_number(cursor.peek().text);
  if (!number) cursor.fail();
  cursor.take();
  return minus ? -*number : *number;
}

std::vector<double> parse_list(Cursor& cursor, const Variables& variables) {
  std::vector<double> numbers;
  cursor.expect_symbol('[');
  if (cursor.take_symbol(']')) return numbers;
  do {
    // A list in a list is refused here: it would let a long line recurse deeply.
    if (cursor.peek().text == "[") cursor.fail();
    const int column = cursor.peek().column;
    const Value value = parse_value(cursor, variables);
    const double* number = std::get_if<double>(&value);
    if (number == nullptr) fail_syntax(cursor.line(), column);
    numbers.push_back(*number);
  } while (cursor.take_symbol(','));
  cursor.expect_symbol(']');
  return numbers;
}

Value parse_pose(Cursor& cursor, const Variables& variables) {
  const int column = cursor.peek().column;
  const std::vector<double> numbers = parse_list(cursor, variables);
  Pose pose;
  if (numbers.size() != pose.values.size()) fail_with(cursor.line(), column, "compile_error_wrong_pose_length:p:");
  std::copy(numbers.begin(), numbers.end(), pose.values.begin());
  return pose;
}

Value parse_named(Cursor& cursor, const Variables& variables) {
  const Token name = cursor.take();
  if (name.text == "p" && cursor.peek().text == "[") return parse_pose(cursor, variables);
  if (name.text == "True" || name.text == "False") return name.text == "True";
  const auto found = variables.find(name.text);
  if (found != variables.end()) return found->second;
  fail_with(cursor.line(), name.column, "compile_error_name_not_found:" + name.text + ":");
}

Value parse_value(Cursor& cursor, const Variables& variables) {
  switch (cursor.peek().kind) {
    case Token::Kind::Name:
      return parse_named(cursor, variables);
    case Token::Kind::Text: {
      const std::string quoted = cursor.take().text;
      return quoted.substr(1, quoted.size() - 2);
    }
    default:
      if (cursor.peek().text == "[") return parse_list(cursor, variables);
      return parse_signed_number(cursor);
  }
}

/** `key=value` or a value; only the `=` behind it marks a key, so the cursor may have to go back. */
Argument parse_argument(Cursor& cursor, const Variables& variables) {
  Argument argument;
  argument.column = cursor.peek().column;
  if (cursor.peek().kind == Token::Kind::Name) {
    const Cursor::Place place = cursor.place();
    const Token name = cursor.take();
    if (cursor.take_symbol('=')) {
      argument.key = name.text;
    } else {
      cursor.back_to(place);
    }
  }
  argument.value = parse_value(cursor, variables);
  return argument;
}

Call parse_call(Cursor& cursor, const Token& name, const Variables& variables) {
  Call call{name.text, name.column, {}};
  cursor.expect_symbol('(');
  if (!cursor.take_symbol(')')) {
    do {
      call.arguments.push_back(parse_argument(cursor, variables));
    } while (cursor.take_symbol(','));
    cursor.expect_symbol(')');
  }
  cursor.expect_end();
  return call;
}

}  // namespace

Token Cursor::take() {
  Token token = peek();
  if (!at_end()) ++at_;
  return token;
}

bool Cursor::take_symbol(char symbol) {
  const Token& token = peek();
  if (token.kind != Token::Kind::Symbol || token.text.front() != symbol) return false;
  ++at_;
  return true;
}

void Cursor::expect_symbol(char symbol) {
  if (!take_symbol(symbol)) fail();
}

Token Cursor::expect_name() {
  if (peek().kind != Token::Kind::Name) fail();
  return take();
}

void Cursor::expect_end() const {
  if (!at_end()) fail();
}

std::optional<Call> parse_statement(const ScriptLine& line, Variables& variables) {
  Cursor cursor(line);
  if (cursor.at_end()) return std::nullopt;
  Token name = cursor.expect_name();
  const bool scoped = (name.text == "global" || name.text == "local") && cursor.peek().kind == Token::Kind::Name;
  if (scoped) name = cursor.take();
  if (cursor.take_symbol('=')) {
    Value value = parse_value(cursor, variables);
    cursor.expect_end();
    variables.insert_or_assign(name.text, std::move(value));
    return std::nullopt;
  }
  if (scoped) cursor.fail();
  return parse_call(cursor, name, variables);
}

}  // namespace trb::virtual_robots::ur
