// Lines and blocks; what stands in a line is expression.cpp's.
#include <algorithm>
#include <optional>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/builder.hpp"
#include "services/virtual-robots/ur/cursor.hpp"
#include "services/virtual-robots/ur/functions.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::size_t kLongestName = 31;
/** Parts of the language that are refused by name. */
constexpr std::string_view kNotImitated[] = {"thread", "run", "join", "kill", "enter_critical", "exit_critical"};

class ScriptCompiler {
 public:
  explicit ScriptCompiler(Program& program) : builder_(program) {}

  /** The names of all functions are known before the first line is compiled. */
  void announce(const ScriptLine& line) {
    Cursor cursor(line);
    if (!cursor.take_word("def") || cursor.peek().kind != Token::Kind::name) return;
    builder_.program().functions.push_back({cursor.take().text, 0, 0, 0});
    std::uint32_t parameters = 0;
    cursor.take();
    for (; !cursor.at_end(); cursor.take()) parameters += cursor.peek().kind == Token::Kind::name ? 1 : 0;
    builder_.program().functions.back().parameters = parameters;
  }

  void line(const ScriptLine& line) {
    Cursor cursor(line);
    if (cursor.at_end()) return;
    const Token word = cursor.peek();
    if (std::find(std::begin(kNotImitated), std::end(kNotImitated), word.text) != std::end(kNotImitated)) {
      fail_with(line, word.column, "compile_error_not_imitated:" + word.text + ":");
    }
    if (!block_line(cursor) && !jump_line(cursor)) plain_line(cursor);
  }

  void finish(const ScriptLine& last) {
    if (!blocks_.empty()) fail_syntax(last, 1);
    builder_.emit(Op::end, last, 1);
  }

 private:
  struct Block {
    enum class Kind { while_, if_, else_, function };
    Kind kind;
    std::uint32_t start = 0;  ///< of a loop
    std::optional<std::uint32_t> false_jump;
    std::vector<std::uint32_t> ends;  ///< jumps to its end
  };

  bool block_line(Cursor& cursor) {
    const int column = cursor.peek().column;
    if (cursor.take_word("while")) {
      const std::uint32_t start = builder_.here();
      blocks_.push_back({Block::Kind::while_, start, condition(cursor), {}});
    } else if (cursor.take_word("if")) {
      blocks_.push_back({Block::Kind::if_, 0, condition(cursor), {}});
    } else if (cursor.take_word("elif")) {
      other_branch(cursor, column);
      blocks_.back().false_jump = condition(cursor);
    } else if (cursor.take_word("else")) {
      other_branch(cursor, column);
      blocks_.back().kind = Block::Kind::else_;
      cursor.expect_symbol(":");
    } else if (cursor.take_word("def")) {
      begin_function(cursor, column);
    } else if (cursor.take_word("end")) {
      end_block(cursor, column);
    } else {
      return false;
    }
    cursor.expect_end();
    return true;
  }

  std::uint32_t condition(Cursor& cursor) {
    const int column = cursor.peek().column;
    const Shape shape = compile_expression(cursor, builder_);
    if (!fits(Parameter::Kind::boolean, shape)) fail_syntax(cursor.line(), column);
    cursor.expect_symbol(":");
    return builder_.emit(Op::jump_unless, cursor.line(), column);
  }

  void other_branch(const Cursor& cursor, int column) {
    if (blocks_.empty() || blocks_.back().kind != Block::Kind::if_) fail_syntax(cursor.line(), column);
    Block& block = blocks_.back();
    block.ends.push_back(builder_.emit(Op::jump, cursor.line(), column));
    builder_.land(*block.false_jump);
    block.false_jump.reset();
  }

  void begin_function(Cursor& cursor, int column) {
    if (builder_.inside_function() || !blocks_.empty()) fail_syntax(cursor.line(), column);
    const std::string name = cursor.expect_name().text;
    std::vector<std::string> parameters;
    cursor.expect_symbol("(");
    if (!cursor.take_symbol(")")) {
      do {
        parameters.push_back(cursor.expect_name().text);
      } while (cursor.take_symbol(","));
      cursor.expect_symbol(")");
    }
    cursor.expect_symbol(":");
    Block block{Block::Kind::function, 0, {}, {}};
    block.ends.push_back(builder_.emit(Op::jump, cursor.line(), column));
    const auto function = builder_.own_function(name);
    // Outside of a program, or a second one of this name.
    if (!function || builder_.program().functions[*function].entry != 0) fail_syntax(cursor.line(), column);
    builder_.enter(*function, parameters);
    blocks_.push_back(std::move(block));
  }

  void end_block(const Cursor& cursor, int column) {
    if (blocks_.empty()) fail_syntax(cursor.line(), column);
    const Block block = std::move(blocks_.back());
    blocks_.pop_back();
    if (block.kind == Block::Kind::while_) builder_.emit(Op::jump, cursor.line(), column, block.start);
    if (block.kind == Block::Kind::function) {
      builder_.emit_constant(std::monostate(), cursor.line(), column);
      builder_.emit(Op::return_, cursor.line(), column);
      builder_.leave();
    }
    if (block.false_jump) builder_.land(*block.false_jump);
    for (const std::uint32_t jump : block.ends) builder_.land(jump);
  }

  /** break, continue, return, halt, pass */
  bool jump_line(Cursor& cursor) {
    const int column = cursor.peek().column;
    if (cursor.take_word("break")) {
      loop(cursor, column).ends.push_back(builder_.emit(Op::jump, cursor.line(), column));
    } else if (cursor.take_word("continue")) {
      builder_.emit(Op::jump, cursor.line(), column, loop(cursor, column).start);
    } else if (cursor.take_word("return")) {
      if (cursor.at_end()) {
        builder_.emit_constant(std::monostate(), cursor.line(), column);
      } else {
        compile_expression(cursor, builder_);
      }
      builder_.emit(Op::return_, cursor.line(), column);
    } else if (cursor.take_word("halt")) {
      builder_.emit(Op::end, cursor.line(), column);
    } else if (!cursor.take_word("pass")) {
      return false;
    }
    cursor.expect_end();
    return true;
  }

  Block& loop(const Cursor& cursor, int column) {
    for (auto block = blocks_.rbegin(); block != blocks_.rend() && block->kind != Block::Kind::function; ++block) {
      if (block->kind == Block::Kind::while_) return *block;
    }
    fail_syntax(cursor.line(), column);
  }

  /** An assignment or a call. */
  void plain_line(Cursor& cursor) {
    const Cursor::Place start = cursor.place();
    Token name = cursor.expect_name();
    auto where = Builder::Where::anywhere;
    const bool scoped = (name.text == "global" || name.text == "local") && cursor.peek().kind == Token::Kind::name;
    if (scoped) {
      where = name.text == "global" ? Builder::Where::global : Builder::Where::local;
      name = cursor.take();
    }
    if (cursor.take_symbol("=")) {
      const Shape shape = compile_expression(cursor, builder_);
      cursor.expect_end();
      const Builder::Variable& variable = builder_.assign(name.text, where, shape);
      builder_.emit(variable.local ? Op::store_local : Op::store, cursor.line(), name.column, variable.index);
      return;
    }
    if (!scoped && cursor.at_symbol("[")) return element_line(cursor, name);
    if (scoped || !cursor.at_symbol("(")) cursor.fail();
    cursor.back_to(start);
    compile_expression(cursor, builder_);
    cursor.expect_end();
    builder_.emit(Op::drop, cursor.line(), name.column);
  }

  /** `NAME[index] = value` */
  void element_line(Cursor& cursor, const Token& name) {
    const Builder::Variable* found = builder_.find(name.text);
    if (found == nullptr) fail_with(cursor.line(), name.column, "compile_error_name_not_found:" + name.text + ":");
    const Builder::Variable variable = *found;
    builder_.emit(variable.local ? Op::load_local : Op::load, cursor.line(), name.column, variable.index);
    cursor.expect_symbol("[");
    compile_expression(cursor, builder_);
    cursor.expect_symbol("]");
    cursor.expect_symbol("=");
    compile_expression(cursor, builder_);
    cursor.expect_end();
    builder_.emit(Op::set_element, cursor.line(), name.column);
    builder_.emit(variable.local ? Op::store_local : Op::store, cursor.line(), name.column, variable.index);
  }

  Builder builder_;
  std::vector<Block> blocks_;
};

/** `def NAME():` or `sec NAME():`. */
Program parse_header(const ScriptLine& line) {
  Cursor cursor(line);
  Program program;
  program.secondary = cursor.expect_name().text == "sec";
  const Token name = cursor.expect_name();
  if (name.text.size() > kLongestName) fail_syntax(line, name.column);
  program.name = name.text;
  for (const char* symbol : {"(", ")", ":"}) cursor.expect_symbol(symbol);
  cursor.expect_end();
  return program;
}

Program compile_definition(std::string_view text) {
  const std::vector<std::string> lines = split(text, '\n');
  Program program = parse_header({1, lines.front()});
  ScriptCompiler compiler(program);
  std::vector<ScriptLine> body;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) body.push_back({static_cast<int>(i) + 1, lines[i]});
  for (const ScriptLine& line : body) compiler.announce(line);
  for (const ScriptLine& line : body) {
    const bool indented = line.text.starts_with(' ') || line.text.starts_with('\t');
    if (!indented && tokenize(line).size() > 1) fail_syntax(line, 1);
    compiler.line(line);
  }
  compiler.finish({static_cast<int>(lines.size()), lines.back()});
  return program;
}

Program compile_bare(std::string_view text) {
  Program program;
  program.name = "unnamed";
  ScriptCompiler compiler(program);
  compiler.line({1, text});
  compiler.finish({1, text});
  return program;
}

}  // namespace

void fail_syntax(const ScriptLine& line, int column) {
  constexpr std::size_t kLongestQuote = 200;
  const std::string quote(line.text.substr(0, kLongestQuote));
  fail_with(line, column, "syntax_error_on_line:" + std::to_string(line.number) + ":" + quote + ":");
}

void fail_with(const ScriptLine& line, int column, std::string text) {
  throw CompileFailure{{line.number, column, std::move(text)}};
}

std::variant<Program, ScriptError> compile(std::string_view text) {
  try {
    const bool definition = text.starts_with("def ") || text.starts_with("sec ");
    return definition ? compile_definition(text) : compile_bare(text);
  } catch (const CompileFailure& failure) {
    return failure.error;
  }
}

}  // namespace trb::virtual_robots::ur
