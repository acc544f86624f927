#pragma once

#include <map>
#include <optional>
#include <string>

#include "services/virtual-robots/ur/program.hpp"
#include "services/virtual-robots/ur/shape.hpp"

namespace trb::virtual_robots::ur {

/** A program under construction, with the names that its lines know so far. */
class Builder {
 public:
  struct Variable {
    bool local = false;
    std::uint32_t index = 0;
    Shape shape;
  };
  enum class Where { anywhere, global, local };

  explicit Builder(Program& program) : program_(program) {}

  Program& program() { return program_; }
  std::uint32_t here() const { return static_cast<std::uint32_t>(program_.code.size()); }

  /** Returns the place of the instruction. */
  std::uint32_t emit(Op op, const ScriptLine& line, int column, std::uint32_t a = 0, std::uint32_t b = 0) {
    program_.code.push_back({op, a, b, line.number, column});
    return here() - 1;
  }
  void emit_constant(Value value, const ScriptLine& line, int column) {
    program_.constants.push_back(std::move(value));
    emit(Op::constant, line, column, static_cast<std::uint32_t>(program_.constants.size() - 1));
  }
  /** A jump goes to the next instruction. */
  void land(std::uint32_t jump) { program_.code[jump].a = here(); }

  const Variable* find(const std::string& name) const;
  /** The variable that an assignment is to; a new one, if there is none. */
  Variable& assign(const std::string& name, Where where, const Shape& shape);

  /** What is assigned from now on belongs to a function, until leave. */
  void enter(std::uint32_t function, const std::vector<std::string>& parameters);
  void leave();
  bool inside_function() const { return function_.has_value(); }

  std::optional<std::uint32_t> own_function(std::string_view name) const;

  /** Expressions in one another, so that none can exhaust the stack. */
  class Nested {
   public:
    explicit Nested(Builder& builder) : builder_(builder) { ++builder_.depth_; }
    ~Nested() { --builder_.depth_; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;
    bool too_deep() const { return builder_.depth_ > 64; }

   private:
    Builder& builder_;
  };

 private:
  Program& program_;
  std::map<std::string, Variable, std::less<>> globals_;
  std::map<std::string, Variable, std::less<>> locals_;
  std::optional<std::uint32_t> function_;
  int depth_ = 0;
};

/** Compiles the expression at the cursor: its value is on top of the stack. Throws CompileFailure. */
class Cursor;
Shape compile_expression(Cursor& cursor, Builder& builder);

}  // namespace trb::virtual_robots::ur
