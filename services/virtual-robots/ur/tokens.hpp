#pragma once

#include <string>
#include <vector>

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

struct Token {
  enum class Kind { name, number, text, symbol, end };
  Kind kind = Kind::end;
  std::string text;
  int column = 0;
};

/** The tokens of one line, without its comment; the last one is always End. Throws CompileFailure. */
std::vector<Token> tokenize(const ScriptLine& line);

}  // namespace trb::virtual_robots::ur
