#include <optional>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/functions.hpp"
#include "services/virtual-robots/ur/script.hpp"
#include "services/virtual-robots/ur/statement.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::size_t kLongestName = 31;

bool takes_time(const Step& step) {
  return std::holds_alternative<MoveStep>(step) || std::holds_alternative<SpeedStep>(step) ||
         std::holds_alternative<SleepStep>(step);
}

/** `def NAME():` or `sec NAME():`. */
Program parse_header(const ScriptLine& line) {
  Cursor cursor(line);
  Program program;
  program.secondary = cursor.expect_name().text == "sec";
  const Token name = cursor.expect_name();
  if (name.text.size() > kLongestName) fail_syntax(line, name.column);
  program.name = name.text;
  for (const char symbol : {'(', ')', ':'}) cursor.expect_symbol(symbol);
  cursor.expect_end();
  return program;
}

void add_line(const ScriptLine& line, Variables& variables, Program& program) {
  const std::optional<Call> call = parse_statement(line, variables);
  if (!call) return;
  Step step = bind_call(line, *call);
  if (program.secondary && takes_time(step)) {
    fail_with(line, call->column, "compile_error_not_in_secondary_program:" + call->function + ":");
  }
  program.steps.push_back(std::move(step));
}

Program compile_definition(std::string_view text) {
  const std::vector<std::string> lines = split(text, '\n');
  Program program = parse_header({1, lines.front()});
  Variables variables;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const ScriptLine line{static_cast<int>(i) + 1, lines[i]};
    const bool indented = lines[i].starts_with(' ') || lines[i].starts_with('\t');
    if (!indented && tokenize(line).size() > 1) fail_syntax(line, 1);
    add_line(line, variables, program);
  }
  return program;
}

Program compile_bare(std::string_view text) {
  Program program{"unnamed", false, {}};
  Variables variables;
  add_line({1, text}, variables, program);
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
