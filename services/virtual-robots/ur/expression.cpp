#include <algorithm>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/builder.hpp"
#include "services/virtual-robots/ur/cursor.hpp"
#include "services/virtual-robots/ur/functions.hpp"

namespace trb::virtual_robots::ur {
namespace {

struct Operator {
  std::string_view symbol;
  Op op;
  int binds;  ///< the higher the tighter
  Shape::Kind gives;
};
constexpr Operator kOperators[] = {
    {"or", Op::or_, 1, Shape::Kind::boolean},           {"xor", Op::xor_, 1, Shape::Kind::boolean},
    {"and", Op::and_, 2, Shape::Kind::boolean},         {"==", Op::equal, 3, Shape::Kind::boolean},
    {"!=", Op::unequal, 3, Shape::Kind::boolean},       {"<", Op::less, 3, Shape::Kind::boolean},
    {"<=", Op::less_equal, 3, Shape::Kind::boolean},    {">", Op::greater, 3, Shape::Kind::boolean},
    {">=", Op::greater_equal, 3, Shape::Kind::boolean}, {"+", Op::add, 4, Shape::Kind::number},
    {"-", Op::subtract, 4, Shape::Kind::number},        {"*", Op::multiply, 5, Shape::Kind::number},
    {"/", Op::divide, 5, Shape::Kind::number},          {"%", Op::modulo, 5, Shape::Kind::number},
};

/** What a call gives for one parameter, before its place is known. */
struct Argument {
  std::string key;
  Shape shape;
  int column = 0;
};

class ExpressionCompiler {
 public:
  ExpressionCompiler(Cursor& cursor, Builder& builder) : cursor_(cursor), builder_(builder) {}

  Shape binary(int binds) {
    const Builder::Nested nested(builder_);
    if (nested.too_deep()) cursor_.fail();
    Shape left = unary();
    while (const Operator* found = next_operator(binds)) {
      const int column = cursor_.take().column;
      binary(found->binds + 1);
      emit(found->op, column);
      left = {found->gives, {}, {}};
    }
    return left;
  }

 private:
  const Operator* next_operator(int binds) const {
    const Token& token = cursor_.peek();
    if (token.kind != Token::Kind::symbol && token.kind != Token::Kind::name) return nullptr;
    for (const Operator& each : kOperators) {
      if (each.symbol == token.text && each.binds >= binds) return &each;
    }
    return nullptr;
  }

  Shape unary() {
    const int column = cursor_.peek().column;
    if (cursor_.take_word("not")) {
      binary(3);
      emit(Op::not_, column);
      return {Shape::Kind::boolean, {}, {}};
    }
    const bool minus = cursor_.take_symbol("-");
    if (!minus) cursor_.take_symbol("+");
    if (cursor_.at_symbol("-") || cursor_.at_symbol("+")) cursor_.fail();
    Shape shape = element();
    if (!minus) return shape;
    if (shape.number) {
      Value& literal = builder_.program().constants.back();
      literal = -*shape.number;
      shape.number = -*shape.number;
      return shape;
    }
    emit(Op::negate, column);
    return {Shape::Kind::number, {}, {}};
  }

  /** A value and what is taken from it: `list[0]`. */
  Shape element() {
    Shape shape = primary();
    while (cursor_.at_symbol("[")) {
      const int column = cursor_.take().column;
      binary(1);
      cursor_.expect_symbol("]");
      emit(Op::element, column);
      shape = {Shape::Kind::number, {}, {}};
    }
    return shape;
  }

  Shape primary() {
    const Token& token = cursor_.peek();
    switch (token.kind) {
      case Token::Kind::name:
        return named();
      case Token::Kind::text: {
        const std::string quoted = token.text;
        return constant(quoted.substr(1, quoted.size() - 2));
      }
      case Token::Kind::number: {
        const auto number = parse_number(token.text);
        if (!number) cursor_.fail();
        return constant(*number);
      }
      default:
        break;
    }
    if (cursor_.at_symbol("[")) return list();
    cursor_.expect_symbol("(");
    Shape shape = binary(1);
    cursor_.expect_symbol(")");
    shape.number.reset();  // a sign before the bracket is not the literal's
    return shape;
  }

  Shape constant(Value value) {
    const int column = cursor_.take().column;
    const Shape shape = shape_of(value);
    builder_.emit_constant(std::move(value), cursor_.line(), column);
    return shape;
  }

  Shape list() {
    const int column = cursor_.peek().column;
    cursor_.expect_symbol("[");
    std::size_t count = 0;
    if (!cursor_.take_symbol("]")) {
      do {
        if (cursor_.at_symbol("[")) cursor_.fail();  // no lists of lists
        const int at = cursor_.peek().column;
        if (!fits(Parameter::Kind::number, binary(1))) fail_syntax(cursor_.line(), at);
        ++count;
      } while (cursor_.take_symbol(","));
      cursor_.expect_symbol("]");
    }
    emit(Op::list, column, static_cast<std::uint32_t>(count));
    return {Shape::Kind::list, count, {}};
  }

  Shape named() {
    const Token name = cursor_.take();
    if (name.text == "p" && cursor_.at_symbol("[")) return pose(cursor_.peek().column);
    if (name.text == "True" || name.text == "False") {
      builder_.emit_constant(name.text == "True", cursor_.line(), name.column);
      return {Shape::Kind::boolean, {}, {}};
    }
    if (cursor_.at_symbol("(")) return call(name);
    const Builder::Variable* variable = builder_.find(name.text);
    if (variable == nullptr) fail_at(name, "name_not_found");
    emit(variable->local ? Op::load_local : Op::load, name.column, variable->index);
    Shape shape = variable->shape;
    shape.number.reset();  // it may have changed
    return shape;
  }

  Shape pose(int column) {
    if (list().count != kPoseSize) fail_with(cursor_.line(), column, "compile_error_wrong_pose_length:p:");
    builder_.program().code.back().op = Op::pose;
    return {Shape::Kind::pose, {}, {}};
  }

  std::vector<Argument> arguments() {
    std::vector<Argument> out;
    cursor_.expect_symbol("(");
    if (cursor_.take_symbol(")")) return out;
    do {
      Argument argument{"", {}, cursor_.peek().column};
      const Cursor::Place place = cursor_.place();
      if (cursor_.peek().kind == Token::Kind::name) argument.key = cursor_.take().text;
      if (!argument.key.empty() && !cursor_.take_symbol("=")) {
        argument.key.clear();  // only the `=` behind it marks a key
        cursor_.back_to(place);
      }
      argument.shape = binary(1);
      out.push_back(std::move(argument));
    } while (cursor_.take_symbol(","));
    cursor_.expect_symbol(")");
    return out;
  }

  Shape call(const Token& name) {
    if (const auto own = builder_.own_function(name.text)) return call_own(name, *own);
    const Function* function = function_of(name.text);
    if (function == nullptr) fail_at(name, "name_not_found");
    if (builder_.program().secondary && function->takes_time) fail_at(name, "not_in_secondary_program");
    CallSite site{function, {}};
    std::vector<bool> given(function->parameters.size(), false);
    for (const Argument& argument : arguments()) {
      site.places.push_back(place_of(name, *function, argument, site.places.size()));
      given[site.places.back()] = true;
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (function->parameters[i].required && !given[i])
        fail_at(name, "missing_argument", function->parameters[i].name);
    }
    builder_.program().calls.push_back(std::move(site));
    emit(Op::call, name.column, static_cast<std::uint32_t>(builder_.program().calls.size() - 1));
    return {function->gives, {}, {}};
  }

  std::size_t place_of(const Token& name, const Function& function, const Argument& argument, std::size_t place) const {
    const auto& parameters = function.parameters;
    if (!argument.key.empty()) {
      const auto found = std::find_if(parameters.begin(), parameters.end(),
                                      [&](const Parameter& each) { return each.name == argument.key; });
      if (found == parameters.end()) fail_call(name, "unknown_argument", argument.key, argument.column);
      place = static_cast<std::size_t>(found - parameters.begin());
    }
    if (place >= parameters.size()) fail_call(name, "too_many_arguments", "", argument.column);
    const Parameter& parameter = parameters[place];
    if (!fits(parameter.kind, argument.shape)) fail_call(name, "wrong_type", parameter.name, argument.column);
    if (!counts(parameter.kind, argument.shape)) fail_call(name, "wrong_joint_count", "", argument.column);
    return place;
  }

  Shape call_own(const Token& name, std::uint32_t index) {
    const std::vector<Argument> given = arguments();
    const std::uint32_t wanted = builder_.program().functions[index].parameters;
    if (given.size() > wanted) fail_call(name, "too_many_arguments", "", given[wanted].column);
    if (given.size() < wanted) fail_at(name, "missing_argument");
    for (const Argument& argument : given) {
      if (!argument.key.empty()) fail_call(name, "unknown_argument", argument.key, argument.column);
    }
    emit(Op::call_own, name.column, index, wanted);
    return {};
  }

  [[noreturn]] void fail_call(const Token& name, std::string_view what, std::string_view which, int column) const {
    std::string text = "compile_error_" + std::string(what) + ":" + name.text + ":";
    if (!which.empty()) text += std::string(which) + ":";
    fail_with(cursor_.line(), column, text);
  }
  [[noreturn]] void fail_at(const Token& name, std::string_view what, std::string_view which = "") const {
    fail_call(name, what, which, name.column);
  }

  void emit(Op op, int column, std::uint32_t a = 0, std::uint32_t b = 0) {
    builder_.emit(op, cursor_.line(), column, a, b);
  }

  static constexpr std::size_t kPoseSize = 6;
  Cursor& cursor_;
  Builder& builder_;
};

}  // namespace

Shape compile_expression(Cursor& cursor, Builder& builder) {
  return ExpressionCompiler(cursor, builder).binary(1);
}

}  // namespace trb::virtual_robots::ur
