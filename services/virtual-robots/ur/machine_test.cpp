#include "services/virtual-robots/ur/machine.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/ur/controller.hpp"

using namespace trb::virtual_robots::ur;

namespace {

using Texts = std::vector<std::string>;

/** What a program says with textmsg; its error, if it has one, is the last. */
Texts said_by(const std::string& body, const World& world = {}) {
  auto compiled = compile("def test():\n" + body + "\nend");
  if (const auto* error = std::get_if<ScriptError>(&compiled)) {
    return {std::to_string(error->line) + ":" + std::to_string(error->column) + " " + error->text};
  }
  Machine machine(std::move(std::get<Program>(compiled)));
  Texts texts;
  for (int round = 0; round < 1000; ++round) {
    auto next = machine.next(world, round);
    if (const auto* error = std::get_if<ScriptError>(&next)) {
      texts.push_back(std::to_string(error->line) + ":" + std::to_string(error->column) + " " + error->text);
    }
    const auto* step = std::get_if<Step>(&next);
    if (step == nullptr) break;
    if (const auto* text = std::get_if<TextStep>(step)) texts.push_back(text->text);
  }
  return texts;
}

Texts value_of(const std::string& expression) {
  return said_by("  textmsg(" + expression + ")");
}

}  // namespace

TEST_CASE("script: expressions reckon with the usual precedence") {
  CHECK(value_of("1 + 2 * 3 - 4 / 2") == Texts{"5.000000"});
  CHECK(value_of("(1 + 2) * -3") == Texts{"-9.000000"});
  CHECK(value_of("-(2)") == Texts{"-2.000000"});
  CHECK(value_of("7 % 4") == Texts{"3.000000"});
  CHECK(value_of("1 < 2 and not 2 <= 1 or False") == Texts{"True"});
  CHECK(value_of("True xor True") == Texts{"False"});
  CHECK(value_of("[1, 2] == [1, 2]") == Texts{"True"});
  CHECK(value_of("p[1,2,3,4,5,6][2]") == Texts{"3.000000"});
  CHECK(value_of("str_cat(\"a\", to_str(1))") == Texts{"a1.000000"});
  CHECK(value_of("norm([3, 4]) + sqrt(9) + d2r(180)") == Texts{"11.141593"});
  CHECK(value_of("length([1, 2, 3])") == Texts{"3.000000"});
}

TEST_CASE("script: while, if, elif, else, break and continue") {
  CHECK(
      said_by("  i = 0\n  while i < 6:\n    i = i + 1\n    if i == 2:\n      continue\n    elif i == 5:\n      break\n"
              "    else:\n      textmsg(i)\n    end\n  end\n  textmsg(\"end\")") ==
      Texts{"1.000000", "3.000000", "4.000000", "end"});
  CHECK(said_by("  if False:\n    textmsg(1)\n  end\n  halt\n  textmsg(2)").empty());
}

TEST_CASE("script: an element is changed in place") {
  CHECK(said_by("  q = [1, 2]\n  q[1] = q[1] + 0.5\n  textmsg(q)") == Texts{"[1.000000, 2.500000]"});
  CHECK(said_by("  x = p[1,2,3,4,5,6]\n  x[2] = 9\n  textmsg(x[2])") == Texts{"9.000000"});
  CHECK(said_by("  q = [1]\n  q[1] = 0") == Texts{"3:3 runtime_error_index_out_of_range:"});
  CHECK(said_by("  q[0] = 1") == Texts{"2:3 compile_error_name_not_found:q:"});
  CHECK(said_by("  q = [1]\n  q[0]").front().find("syntax_error_on_line:3") != std::string::npos);
}

TEST_CASE("script: functions have parameters, values of their own, and give one back") {
  CHECK(said_by("  def add(a, b):\n    local c = a + b\n    return c\n  end\n  textmsg(add(1, add(2, 3)))") ==
        Texts{"6.000000"});
  CHECK(said_by("  global n = 1\n  def up():\n    n = n + 1\n    m = 5\n  end\n  up()\n  up()\n  textmsg(n)") ==
        Texts{"3.000000"});
  CHECK(said_by("  def fact(n):\n    if n <= 1:\n      return 1\n    end\n    return n * fact(n - 1)\n  end\n"
                "  textmsg(fact(5))") == Texts{"120.000000"});
  CHECK(said_by("  def f(a):\n    textmsg(a)\n  end\n  f()") == Texts{"5:3 compile_error_missing_argument:f:"});
  CHECK(said_by("  def f():\n    m = 1\n  end\n  textmsg(m)") == Texts{"5:11 compile_error_name_not_found:m:"});
}

TEST_CASE("script: what goes wrong while it runs is an exception with its place") {
  CHECK(value_of("1 / 0") == Texts{"2:13 runtime_error_division_by_zero:"});
  CHECK(value_of("[1, 2][2]") == Texts{"2:17 runtime_error_index_out_of_range:"});
  CHECK(value_of("1 + True") == Texts{"2:13 runtime_error_wrong_type:"});
  CHECK(value_of("sqrt(-1)") == Texts{"2:11 runtime_error_not_a_number:"});
  CHECK(said_by("  x = [1, 2]\n  if True:\n    x = [1]\n  end\n  movej(x)") ==
        Texts{"6:3 runtime_error_wrong_joint_count:movej:q:"});
  CHECK(said_by("  def f():\n    f()\n  end\n  f()") == Texts{"3:5 runtime_error_too_many_calls_in_one_another:"});
  CHECK(said_by("  while True:\n    x = 1\n  end").back().find("runtime_error_infinite_loop") != std::string::npos);
}

TEST_CASE("script: blocks that do not fit one another, and what is not imitated, are refused by place") {
  for (const char* body : {"  while True:", "  end", "  else:\n  end", "  if 1:\n  end", "  break", "  if True\n  end",
                           "  while True:\n  elif True:\n  end", "  def f():\n    def g():\n    end\n  end",
                           "  x = 1 +", "  def f():\n  end\n  def f():\n  end"}) {
    CAPTURE(body);
    CHECK(said_by(body).front().find("syntax_error_on_line") != std::string::npos);
  }
  CHECK(said_by("  thread t():\n  end") == Texts{"2:3 compile_error_not_imitated:thread:"});
  std::string deep = "  x = ";
  for (int i = 0; i < 2000; ++i) deep += "(";
  CHECK(said_by(deep).front().find("syntax_error_on_line:2") != std::string::npos);
}

TEST_CASE("script: the robot's state is asked for") {
  World world;
  world.state.joints.position = {0.4, -1.1, 1.3, -1.77, -1.57, 0};
  world.state.io.inputs = 2;
  world.inputs.integers[3] = 7;
  CHECK(said_by("  q = get_actual_joint_positions()\n  textmsg(q[2])\n  textmsg(get_standard_digital_in(1))\n"
                "  textmsg(read_input_integer_register(3))\n  textmsg(is_steady())\n"
                "  textmsg(point_dist(get_actual_tcp_pose(), get_target_tcp_pose()))\n"
                "  textmsg(norm(get_inverse_kin(get_actual_tcp_pose())[0] - 0.4) < 0.001)\n"
                "  textmsg(get_inverse_kin_has_solution(p[10,0,0,0,0,0]))",
                world) == Texts{"1.300000", "True", "7.000000", "True", "0.000000", "True", "False"});
  world.state.io.outputs = 1 << 9;
  CHECK(said_by("  textmsg(get_configurable_digital_out(1))\n  textmsg(get_tool_digital_out(1))\n  "
                "set_tool_digital_out(2, True)",
                world) == Texts{"True", "False", "4:3 runtime_error_no_pin:2.000000:"});
  CHECK(said_by("  textmsg(read_input_integer_register(99))") == Texts{"2:11 runtime_error_no_register:99.000000:"});
}

TEST_CASE("script: a loop of speeds runs round by round, and a program stops itself") {
  Controller controller;
  controller.take(
      "def go():\n  while get_actual_joint_positions()[0] < 0.5:\n    speedj([0.5,0,0,0,0,0], 5, 0.002)\n"
      "    sync()\n  end\n  stopj(5)\n  write_output_integer_register(1, 42)\n  protective_stop()\n"
      "  textmsg(\"never\")\nend",
      0);
  for (int step = 0; step < 300; ++step) controller.advance(step * 0.01);
  const RobotState state = controller.state(3);
  CHECK(state.joints.position[0] == doctest::Approx(0.5).epsilon(0.1));
  CHECK(state.safety == SafetyMode::protective_stop);
  CHECK_FALSE(state.program_running);
  CHECK(controller.output_registers().integers[1] == 42);
  CHECK_FALSE(controller.unlock(5));
  CHECK(controller.unlock(7));
}

TEST_CASE("script: a loop that never waits ends, and the robot goes on") {
  Controller controller;
  controller.take("def spin():\n  while True:\n    set_digital_out(0, True)\n  end\nend", 0);
  CHECK_FALSE(controller.state(0).program_running);
  controller.take("sleep(1)", 0);
  CHECK(controller.state(0).program_running);
}
