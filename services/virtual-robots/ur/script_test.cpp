#include "services/virtual-robots/ur/program.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/ur/intake.hpp"
#include "services/virtual-robots/ur/machine.hpp"

using namespace trb::virtual_robots::ur;

namespace {

Program program_of(std::string_view text) {
  auto compiled = compile(text);
  if (const auto* error = std::get_if<ScriptError>(&compiled)) FAIL(error->text);
  return std::get<Program>(compiled);
}

std::vector<Step> steps_of(std::string_view text) {
  Machine machine(program_of(text));
  std::vector<Step> steps;
  for (;;) {
    auto next = machine.next({}, 0);
    const auto* step = std::get_if<Step>(&next);
    if (step == nullptr) return steps;
    steps.push_back(*step);
  }
}

ScriptError error_of(std::string_view text) {
  auto compiled = compile(text);
  REQUIRE(std::holds_alternative<ScriptError>(compiled));
  return std::get<ScriptError>(compiled);
}

void check_error(std::string_view text, int line, int column, std::string_view what) {
  const ScriptError error = error_of(text);
  CHECK(error.line == line);
  CHECK(error.column == column);
  CHECK(error.text == what);
}

}  // namespace

TEST_CASE("compile: a program with every kind of statement") {
  const std::vector<Step> steps = steps_of(
      "def pick():\n"
      "  # a comment\n"
      "  home = [0, -1.57, 0, -1.57, 0, 1e-1]\n"
      "  global fast = 2.5\n"
      "  movej(home, a=1.4, v=fast)\n"
      "\n"
      "  movel(p[0.1, 0.2, 0.3, 0, 3.14, 0], t = 2)  # slowly\n"
      "  sleep(0.5)\n"
      "  set_digital_out(3, True)\n"
      "  textmsg(\"a # in a text\", 2)\n"
      "  set_tcp(p[0,0,0.1,0,0,0])\n"
      "  set_payload(1.5, [0, 0, 0.1])\n"
      "  popup(\"look\", blocking=True)\n"
      "  stopj(2.0)\n"
      "end");
  REQUIRE(steps.size() == 9);
  const auto& move = std::get<MoveStep>(steps[0]);
  CHECK(std::get<Joints>(move.target)[1] == -1.57);
  CHECK(move.speed == 2.5);
  CHECK(std::get<Pose>(std::get<MoveStep>(steps[1]).target).values[2] == 0.3);
  CHECK(std::get<MoveStep>(steps[1]).time == 2);
  CHECK(std::get<DigitalOutStep>(steps[3]).on);
  CHECK(std::get<TextStep>(steps[4]).text == "a # in a text2.000000");
}

TEST_CASE("compile: a bare line is a program named unnamed") {
  const Program program = program_of("movej([0,0,0,0,0,0], 1.4, 1.05, 0, 0)");
  CHECK(program.name == "unnamed");
  CHECK(steps_of("movej([0,0,0,0,0,0], 1.4, 1.05, 0, 0)").size() == 1);
}

TEST_CASE("compile: errors carry line and column") {
  check_error("def a():\n  calldoesntexist()\nend", 2, 3, "compile_error_name_not_found:calldoesntexist:");
  check_error("def a():\n  sleep(nothing)\nend", 2, 9, "compile_error_name_not_found:nothing:");
  check_error("def a():\n  sleep(1\nend", 2, 10, "syntax_error_on_line:2:  sleep(1:");
  check_error("def a():\nsleep(1)\nend", 2, 1, "syntax_error_on_line:2:sleep(1):");
  check_error("def a:\nend", 1, 6, "syntax_error_on_line:1:def a::");
  check_error("movej([1,2,3])", 1, 7, "compile_error_wrong_joint_count:movej:");
  check_error("movel(p[1,2,3])", 1, 8, "compile_error_wrong_pose_length:p:");
  check_error("sleep(\"a\")", 1, 7, "compile_error_wrong_type:sleep:t:");
  check_error("sleep(1, 2)", 1, 10, "compile_error_too_many_arguments:sleep:");
  check_error("sleep()", 1, 1, "compile_error_missing_argument:sleep:t:");
  check_error("sleep(x=1)", 1, 7, "compile_error_unknown_argument:sleep:x:");
}

TEST_CASE("compile: what is no statement is a syntax error") {
  for (const char* line : {"while True:", "x = ", "x = [1, [2]]", "sleep(1e999)", "\"open", "sleep(1) sleep(2)",
                           "local x", "sleep(1.2.3)", "$", "x = -", "sleep(,)", "(", "= 3", "sleep(--1)"}) {
    CAPTURE(line);
    CHECK(error_of(line).text.starts_with("syntax_error_on_line:1:"));
  }
  CHECK(error_of("def a23456789012345678901234567890xx():\nend").text.starts_with("syntax_error_on_line:1:"));
}

TEST_CASE("compile: a secondary program must not take time") {
  CHECK(program_of("sec out():\n  set_digital_out(1, False)\nend").secondary);
  check_error("sec out():\n  sleep(1)\nend", 2, 3, "compile_error_not_in_secondary_program:sleep:");
}

TEST_CASE("compile: every beginning of a program gives an error or a program, never a crash") {
  const std::string text = "def pick():\n  a = p[1, 2, 3, 4, 5, 6]\n  movej(a, v=-1.5e0)\n  textmsg(\"x\", True)\nend";
  for (std::size_t length = 0; length <= text.size(); ++length) {
    const auto compiled = compile(text.substr(0, length));
    if (length == text.size()) CHECK(std::holds_alternative<Program>(compiled));
  }
}

TEST_CASE("intake: programs and lines, whatever the pieces") {
  const std::string bytes = "\r\n# nothing\npower on\r\ndef a():\n  sleep(1)\nend\r\nstop program\n";
  const std::vector<std::string> expected{"power on", "def a():\n  sleep(1)\nend", "stop program"};
  Intake whole;
  CHECK(whole.take(bytes) == expected);
  Intake bytewise;
  std::vector<std::string> scripts;
  for (const char byte : bytes) {
    for (std::string& script : bytewise.take({&byte, 1})) scripts.push_back(std::move(script));
  }
  CHECK(scripts == expected);
}

TEST_CASE("intake: an indented end and a name that begins with end close nothing") {
  Intake intake;
  CHECK(intake.take("def a():\n  end\nending()\n").empty());
  CHECK(intake.take("end # a\n").size() == 1);
}

TEST_CASE("intake: bounds") {
  Intake line;
  line.take(std::string(Intake::kLongestLine, 'x'));
  CHECK(line.fault().empty());
  line.take("x");
  CHECK(line.fault() == "line_too_long");
  Intake program;
  program.take("def a():\n");
  const std::string body(60000, ' ');
  for (int i = 0; i < 17; ++i) program.take(body + "\n");
  CHECK(program.fault().empty());
  program.take(body + "\n");
  CHECK(program.fault() == "program_too_long");
}
