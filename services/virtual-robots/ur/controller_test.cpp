#include "services/virtual-robots/ur/controller.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::ur;

namespace {

/** A controller, the clock of its test, and the lines printed since the last look. */
struct Bench {
  explicit Bench(RobotMode mode = RobotMode::Running) : controller(mode) {}

  void take(std::string_view script) { controller.take(script, now); }
  void wait(double seconds) { controller.advance(now += seconds); }
  double joint(std::size_t index) const { return controller.state(now).joints.position[index]; }
  bool running() const { return controller.state(now).program_running; }

  std::vector<std::string> lines() {
    std::vector<std::string> out;
    for (const Event& event : controller.take_events()) out.push_back(line_of(event));
    return out;
  }

  Controller controller;
  double now = 0;
};

using Lines = std::vector<std::string>;

constexpr std::string_view kMoveOne = "def one():\n  movej([1.05, -1.5708, 0, -1.5708, 0, 0])\nend";
const std::string kMoveOneLine = "move movej 1.0500 -1.5708 0.0000 -1.5708 0.0000 0.0000";

}  // namespace

TEST_CASE("controller: a move takes the way of the farthest joint divided by the speed") {
  Bench bench;
  bench.take(kMoveOne);
  CHECK(bench.lines() == Lines{"program one started", kMoveOneLine});
  CHECK(bench.controller.next_deadline() == doctest::Approx(1.0));
  bench.wait(0.5);
  CHECK(bench.joint(0) == doctest::Approx(0.525));
  CHECK(bench.controller.state(bench.now).joints.speed[0] == doctest::Approx(1.05));
  CHECK(bench.controller.state(bench.now).joints.target[0] == 1.05);
  CHECK(bench.running());
  bench.wait(0.5);
  CHECK(bench.lines() == Lines{"program one stopped"});
  CHECK(bench.joint(0) == 1.05);
  CHECK(bench.controller.state(bench.now).joints.speed[0] == 0);
  CHECK_FALSE(bench.controller.next_deadline());
}

TEST_CASE("controller: time and speed of a move, and the shortest one") {
  Bench bench;
  bench.take("movej([1,-1.5708,0,-1.5708,0,0], v=0.5, t=4)");
  CHECK(bench.controller.next_deadline() == doctest::Approx(4.0));
  bench.wait(4);
  bench.take("movej([0,-1.5708,0,-1.5708,0,0], v=0.5)");
  CHECK(bench.controller.next_deadline() == doctest::Approx(6.0));
  bench.wait(2);
  bench.take("movej([0,-1.5708,0,-1.5708,0,0])");
  CHECK(bench.controller.next_deadline() == doctest::Approx(6.1));
}

TEST_CASE("controller: a move to a pose takes its distance and leaves the joints where they were") {
  Bench bench;
  bench.take("movel(p[0.5, 0, 0, 0, 0, 0])");
  CHECK(bench.lines().back() == "move movel p 0.5000 0.0000 0.0000 0.0000 0.0000 0.0000");
  CHECK(bench.controller.next_deadline() == doctest::Approx(2.0));
  bench.wait(1);
  CHECK(bench.joint(0) == doctest::Approx(0.001));
  bench.wait(1);
  CHECK(bench.joint(0) == doctest::Approx(0.0));
  bench.take("movel(p[0.5, 0, 0, 0, 0, 0])");
  CHECK(bench.controller.next_deadline() == doctest::Approx(2.2));
}

TEST_CASE("controller: a program without any duration still starts and stops") {
  Bench bench;
  bench.take("def quick():\n  textmsg(\"hi\")\n  set_digital_out(2, True)\nend");
  CHECK(bench.lines() == Lines{"program quick started", "text hi", "digital_out 2 on", "program quick stopped"});
}

TEST_CASE("controller: steps follow one another exactly, however late it is called") {
  Bench bench;
  bench.take("def two():\n  sleep(1)\n  textmsg(\"a\")\n  sleep(1)\n  textmsg(\"b\")\nend");
  bench.wait(1.75);
  CHECK(bench.controller.next_deadline() == doctest::Approx(2.0));
  bench.wait(10);
  CHECK(bench.lines() == Lines{"program two started", "text a", "text b", "program two stopped"});
}

TEST_CASE("controller: a new program replaces the running one, a secondary one does not") {
  Bench bench;
  bench.take(kMoveOne);
  bench.lines();
  bench.wait(0.5);
  bench.take("sec out():\n  set_digital_out(1, False)\nend");
  CHECK(bench.lines() == Lines{"secondary out", "digital_out 1 off"});
  CHECK(bench.controller.next_deadline() == doctest::Approx(1.0));
  bench.take("sleep(1)");
  CHECK(bench.lines() == Lines{"program one stopped", "program unnamed started"});
  bench.wait(0.25);
  CHECK(bench.joint(0) == doctest::Approx(0.525));
}

TEST_CASE("controller: a script with an error changes nothing") {
  Bench bench;
  bench.take(kMoveOne);
  bench.lines();
  bench.take("def two():\n  dance()\nend");
  CHECK(bench.lines() == Lines{"script_error 2 3 compile_error_name_not_found:dance:"});
  CHECK(bench.running());
}

TEST_CASE("controller: stop program halts the arm where it is") {
  Bench bench;
  bench.take(kMoveOne);
  bench.lines();
  bench.wait(0.2);
  bench.take("stop program");
  CHECK(bench.lines() == Lines{"program one stopped", "stopped"});
  bench.wait(5);
  CHECK(bench.joint(0) == doctest::Approx(0.21));
  CHECK(bench.controller.state(bench.now).joints.target[0] == doctest::Approx(0.21));
  CHECK_FALSE(bench.running());
}

TEST_CASE("controller: power off, power on, run") {
  Bench bench;
  bench.take(kMoveOne);
  bench.take("power off");
  CHECK(bench.controller.state(0).mode == RobotMode::PowerOff);
  CHECK_FALSE(bench.running());
  bench.lines();
  bench.take(kMoveOne);
  CHECK(bench.lines() == Lines{"error C100A3 robot_not_running", "script_error 1 1 runtime_error_robot_not_running:"});
  bench.take("set robotmode run");
  CHECK(bench.controller.state(0).mode == RobotMode::PowerOff);
  bench.take("power on");
  CHECK(bench.controller.state(0).mode == RobotMode::Idle);
  bench.take("set robotmode run");
  bench.take(kMoveOne);
  CHECK(bench.running());
}

TEST_CASE("controller: a protective stop ends the program until it is unlocked") {
  Bench bench;
  bench.take(kMoveOne);
  bench.lines();
  bench.wait(0.2);
  bench.controller.set_safety(SafetyMode::ProtectiveStop, bench.now);
  CHECK(bench.lines() == Lines{"safety protective_stop", "program one stopped", "stopped"});
  bench.take(kMoveOne);
  CHECK(bench.lines().front() == "error C100A103 robot_not_running");
  bench.take("set unlock protective stop");
  CHECK(bench.lines() == Lines{"safety normal"});
  bench.take(kMoveOne);
  CHECK(bench.running());
}

TEST_CASE("controller: an emergency stop is not lifted by unlocking") {
  Bench bench;
  bench.controller.set_safety(SafetyMode::EmergencyStop, 0);
  bench.take("set unlock protective stop");
  CHECK(bench.controller.state(0).safety == SafetyMode::EmergencyStop);
  bench.controller.set_safety(SafetyMode::Normal, 0);
  CHECK(bench.lines() == Lines{"safety estop", "stopped", "safety normal"});
}
