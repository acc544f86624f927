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
  constant,     ///< a: which
  load,         ///< a: global variable
  store,        ///< a: global variable
  load_local,   ///< a: variable of the function
  store_local,  ///< a: variable of the function
  drop,         ///< the value on top
  negate,
  not_,
  add,
  subtract,
  multiply,
  divide,
  modulo,
  equal,
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  and_,
  or_,
  xor_,
  list,         ///< a: how many values
  pose,         ///< of six values
  element,      ///< list, index
  set_element,  ///< list, index, value: the list with that value
  jump,         ///< a: to where
  jump_unless,  ///< a: to where
  call,         ///< a: call of the controller's function
  call_own,     ///< a: function of the program; b: how many values it is given
  return_,      ///< with the value on top
  end           ///< of the program
};

struct Instruction {
  Op op = Op::end;
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
