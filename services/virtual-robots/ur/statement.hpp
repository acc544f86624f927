#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/ur/script.hpp"
#include "services/virtual-robots/ur/tokens.hpp"

namespace trb::virtual_robots::ur {

/** One argument of a call; the key is empty for a positional one. */
struct Argument {
  std::string key;
  Value value;
  int column = 0;
};

struct Call {
  std::string function;
  int column = 0;
  std::vector<Argument> arguments;
};

/** The tokens of a line, and errors about them. */
class Cursor {
 public:
  using Place = std::size_t;

  explicit Cursor(const ScriptLine& line) : line_(line), tokens_(tokenize(line)) {}

  const Token& peek() const { return tokens_[at_]; }
  Place place() const { return at_; }
  void back_to(Place place) { at_ = place; }
  bool at_end() const { return peek().kind == Token::Kind::End; }
  Token take();
  bool take_symbol(char symbol);
  void expect_symbol(char symbol);
  Token expect_name();
  void expect_end() const;
  const ScriptLine& line() const { return line_; }
  [[noreturn]] void fail() const { fail_syntax(line_, peek().column); }

 private:
  ScriptLine line_;
  std::vector<Token> tokens_;
  Place at_ = 0;
};

/** Parses a line: an assignment sets a variable, a call is returned, a blank line is nothing. */
std::optional<Call> parse_statement(const ScriptLine& line, Variables& variables);

}  // namespace trb::virtual_robots::ur
