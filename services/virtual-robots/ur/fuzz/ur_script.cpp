// The programs that a client sends to the virtual Universal Robot: compiled, and carried out for a while.
#include "services/virtual-robots/ur/intake.hpp"
#include "services/virtual-robots/ur/machine.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace virtual_robots::ur;

void carry_out(Program program) {
  Machine machine(std::move(program));
  const World world;
  for (int round = 0; round < 200; ++round) {
    const auto next = machine.next(world, round * 0.1);
    if (!std::holds_alternative<Step>(next)) return;
  }
}

}  // namespace

std::vector<trb::Bytes> seeds() {
  return {"def pick():\n  a = p[1, 2, 3, 4, 5, 6]\n  movej(a, v=-1.5e0)\n  textmsg(\"x\", True)\nend\n",
          "def go():\n  i = 0\n  while i < 3 and True:\n    i = i + 1\n    if i == 2:\n      continue\n    else:\n     "
          " break\n"
          "    end\n  end\nend\n",
          "def f():\n  def add(a, b):\n    return a + b * -2\n  end\n  x = add(1, [2, 3][0])\n  global y = x % 2\n  "
          "halt\nend\n",
          "sec out():\n  set_digital_out(1, False)\nend\n",
          "q = get_inverse_kin(get_actual_tcp_pose(), get_actual_joint_positions())\npower on\nmovej([0,0,0,0,0,0])\n"};
}

void run(BytesView input) {
  Intake intake;
  for (const std::string& script : intake.take(input)) {
    auto compiled = compile(script);
    if (auto* program = std::get_if<Program>(&compiled)) {
      carry_out(std::move(*program));
    } else {
      const auto& error = std::get<ScriptError>(compiled);
      require(error.line >= 1 && error.column >= 1 && !error.text.empty(), "an error has a place and a text");
    }
  }
}

}  // namespace trb::fuzz
