#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

struct Function;

/** What a stack machine carries out; `a` and `b` are what the comment says. */
enum class Op : std::uint8_t {
  Constant,    ///< a: which
  Load,        ///< a: global variable
  Store,       ///< a: global variable
  LoadLocal,   ///< a: variable of the function
  StoreLocal,  ///< a: variable of the function
  Drop,        ///< the value on top
  Negate,
  Not,
  Add,
  Subtract,
  Multiply,
  Divide,
  Modulo,
  Equal,
  Unequal,
  Less,
  LessEqual,
  Greater,
  GreaterEqual,
  And,
  Or,
  Xor,
  List,        ///< a: how many values
  Pose,        ///< of six values
  Element,     ///< list, index
  SetElement,  ///< list, index, value: the list with that value
  Jump,        ///< a: to where
  JumpUnless,  ///< a: to where
  Call,        ///< a: call of the controller's function
  CallOwn,     ///< a: function of the program; b: how many values it is given
  Return,      ///< with the value on top
  End          ///< of the program
};

struct Instruction {
  Op op = Op::End;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  int line = 1;
  int column = 1;
};

/** A call of a function of the controller's: which of its parameters each value is for. */
struct CallSite {
  const Function* function = nullptr;
  std::vector<std::size_t> places;
};

/** A function that the program defines. */
struct OwnFunction {
  std::string name;
  std::uint32_t parameters = 0;
  std::uint32_t entry = 0;
  std::uint32_t locals = 0;  ///< parameters included
};

/** A compiled script. */
struct Program {
  std::string name;
  bool secondary = false;
  std::vector<Instruction> code;
  std::vector<Value> constants;
  std::vector<CallSite> calls;
  std::vector<OwnFunction> functions;
  std::uint32_t globals = 0;
};

/** Compiles `def NAME(): ... end`, `sec NAME(): ... end`, or one bare statement, which gets the name `unnamed`. */
std::variant<Program, ScriptError> compile(std::string_view text);

}  // namespace trb::virtual_robots::ur
