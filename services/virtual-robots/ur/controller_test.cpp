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
  CHECK(bench.controller.state(bench.now).joints.position[0] < 1.05);  // what it should do is what it does
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

TEST_CASE("controller: movel takes its distance, and the tool goes straight there") {
  Bench bench;
  bench.take("movej([0.4, -1.1, 1.3, -1.77, -1.57, 0])");
  bench.wait(10);
  const Pose start = pose_of(flange_frame(bench.controller.state(bench.now).joints.position));
  Pose aim = start;
  aim.values[2] += 0.1;
  std::string script = "movel(p[";
  for (std::size_t i = 0; i < 6; ++i) script += (i == 0 ? "" : ",") + std::to_string(aim.values[i]);
  bench.take(script + "])");
  CHECK(bench.controller.next_deadline() == doctest::Approx(bench.now + 0.4).epsilon(0.001));
  bench.wait(0.2);
  const Vector half = flange_of(bench.controller.state(bench.now).joints.position);
  CHECK(half[2] == doctest::Approx(start.values[2] + 0.05).epsilon(0.001));
  CHECK(half[0] == doctest::Approx(start.values[0]).epsilon(0.001));
  bench.wait(0.21);
  CHECK(flange_of(bench.controller.state(bench.now).joints.position)[2] ==
        doctest::Approx(aim.values[2]).epsilon(0.001));
  CHECK_FALSE(bench.running());
}

TEST_CASE("controller: a pose out of reach fails at once: movej by an exception with its place, movel by an error") {
  Bench bench;
  bench.take("def far():\n  movej(p[10,0,0,0,0,0])\n  textmsg(\"there\")\nend");
  CHECK(bench.lines() == Lines{"program far started", "move movej p 10.0000 0.0000 0.0000 0.0000 0.0000 0.0000",
                               "script_error 2 3 The robot cannot reach the requested pose. Script function movej is "
                               "unable to find an inverse kinematics solution.",
                               "program far stopped"});
  bench.take("movel(p[10,0,0,0,0,0])");
  CHECK(bench.lines() == Lines{"program unnamed started", "move movel p 10.0000 0.0000 0.0000 0.0000 0.0000 0.0000",
                               "error C154A0 Position in singularity", "program unnamed stopped"});
  CHECK_FALSE(bench.running());
  bench.take("movej([7, 0, 0, 0, 0, 0])");  // a joint turns by one whole turn at most
  CHECK(bench.lines()[2].starts_with("script_error 1 1 The robot cannot reach"));
  bench.take(kMoveOne);
  CHECK(bench.running());
}

TEST_CASE("controller: the tool's centre is what reaches a pose") {
  Bench bench;
  bench.take("movej([0.4, -1.1, 1.3, -1.77, -1.57, 0])");
  bench.wait(10);
  const Joints before = bench.controller.state(bench.now).joints.position;
  const Pose there = pose_of(compose(flange_frame(before), frame_of({{0, 0, 0.1, 0, 0, 0}})));
  std::string script = "def tool():\n  set_tcp(p[0,0,0.1,0,0,0])\n  movej(p[";
  for (std::size_t i = 0; i < 6; ++i) script += (i == 0 ? "" : ",") + std::to_string(there.values[i]);
  bench.take(script + "])\nend");
  bench.wait(10);
  CHECK_FALSE(bench.running());
  for (std::size_t i = 0; i < 6; ++i) CHECK(bench.joint(i) == doctest::Approx(before[i]).epsilon(0.001));
}

TEST_CASE("controller: the speed slider stretches a move, also one that is under way") {
  Bench bench;
  bench.take(kMoveOne);
  bench.wait(0.5);
  bench.controller.set_speed_fraction(0.5, bench.now);
  CHECK(bench.controller.next_deadline() == doctest::Approx(1.5));
  CHECK(bench.controller.state(bench.now).joints.speed[0] == doctest::Approx(0.525));
  bench.controller.set_speed_fraction(0, bench.now);
  CHECK_FALSE(bench.controller.next_deadline());
  bench.wait(9);
  CHECK(bench.joint(0) == doctest::Approx(0.525));
  bench.controller.set_speed_fraction(1, bench.now);
  bench.wait(0.5);
  CHECK(bench.joint(0) == 1.05);
  CHECK_FALSE(bench.running());
}

TEST_CASE("controller: a paused program stands, and goes on from there") {
  Bench bench;
  bench.take(kMoveOne);
  bench.wait(0.5);
  CHECK(bench.controller.pause(bench.now));
  bench.wait(5);
  CHECK(bench.joint(0) == doctest::Approx(0.525));
  CHECK(bench.controller.state(bench.now).program_paused);
  CHECK_FALSE(bench.running());
  CHECK(bench.controller.resume(bench.now));
  CHECK(bench.controller.next_deadline() == doctest::Approx(6.0));
  bench.wait(0.5);
  CHECK(bench.joint(0) == 1.05);
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
  bench.take("power on");
  CHECK(bench.controller.state(0).mode == RobotMode::Idle);
  bench.take("power off");
  bench.take("set robotmode run");  // the power first, by itself
  CHECK(bench.controller.state(0).mode == RobotMode::Running);
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
  bench.wait(4.9);
  bench.take("set unlock protective stop");
  CHECK(bench.controller.state(bench.now).safety == SafetyMode::ProtectiveStop);
  bench.lines();
  bench.wait(0.2);
  bench.take("set unlock protective stop");
  CHECK(bench.lines() == Lines{"safety normal"});
  bench.take(kMoveOne);
  CHECK(bench.running());
}

TEST_CASE("controller: an emergency stop takes the power, and nothing switches it on before it is released") {
  Bench bench;
  bench.controller.set_safety(SafetyMode::EmergencyStop, 0);
  CHECK(bench.controller.state(0).mode == RobotMode::PowerOff);
  for (const char* line : {"set unlock protective stop", "power on", "set robotmode run"}) bench.take(line);
  CHECK(bench.controller.state(0).safety == SafetyMode::EmergencyStop);
  CHECK(bench.controller.state(0).mode == RobotMode::PowerOff);
  bench.controller.set_safety(SafetyMode::Normal, 0);
  CHECK(bench.lines() == Lines{"safety estop", "stopped", "safety normal"});
  CHECK(bench.controller.state(0).mode == RobotMode::PowerOff);
  bench.take("set robotmode run");
  CHECK(bench.controller.state(0).mode == RobotMode::Running);
}
