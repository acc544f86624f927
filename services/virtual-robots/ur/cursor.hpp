#pragma once

#include <string_view>
#include <vector>

#include "services/virtual-robots/ur/tokens.hpp"

namespace trb::virtual_robots::ur {

/** The tokens of a line, and errors about them. */
class Cursor {
 public:
  using Place = std::size_t;

  explicit Cursor(const ScriptLine& line) : line_(line), tokens_(tokenize(line)) {}

  const Token& peek() const { return tokens_[at_]; }
  bool at_word(std::string_view word) const { return peek().kind == Token::Kind::name && peek().text == word; }
  bool at_symbol(std::string_view symbol) const { return peek().kind == Token::Kind::symbol && peek().text == symbol; }
  Place place() const { return at_; }
  void back_to(Place place) { at_ = place; }
  bool at_end() const { return peek().kind == Token::Kind::end; }

  Token take() {
    Token token = peek();
    if (!at_end()) ++at_;
    return token;
  }
  bool take_symbol(std::string_view symbol) {
    if (!at_symbol(symbol)) return false;
    ++at_;
    return true;
  }
  bool take_word(std::string_view word) {
    if (!at_word(word)) return false;
    ++at_;
    return true;
  }
  void expect_symbol(std::string_view symbol) {
    if (!take_symbol(symbol)) fail();
  }
  Token expect_name() {
    if (peek().kind != Token::Kind::name) fail();
    return take();
  }
  void expect_end() const {
    if (!at_end()) fail();
  }
  const ScriptLine& line() const { return line_; }
  [[noreturn]] void fail() const { fail_syntax(line_, peek().column); }

 private:
  ScriptLine line_;
  std::vector<Token> tokens_;
  Place at_ = 0;
};

}  // namespace trb::virtual_robots::ur
