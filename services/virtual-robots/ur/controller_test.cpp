#include "services/virtual-robots/ur/controller.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::ur;

namespace {

/** A controller, the clock of its test, and the lines printed since the last look. */
struct Fixture {
  explicit Fixture(RobotMode mode = RobotMode::running) : controller(mode) {}

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
  Fixture fixture;
  fixture.take(kMoveOne);
  CHECK(fixture.lines() == Lines{"program one started", kMoveOneLine});
  CHECK(fixture.controller.next_deadline() == doctest::Approx(1.0));
  fixture.wait(0.5);
  CHECK(fixture.joint(0) == doctest::Approx(0.525));
  CHECK(fixture.controller.state(fixture.now).joints.speed[0] == doctest::Approx(1.05));
  CHECK(fixture.controller.state(fixture.now).joints.position[0] < 1.05);  // what it should do is what it does
  CHECK(fixture.running());
  fixture.wait(0.5);
  CHECK(fixture.lines() == Lines{"program one stopped"});
  CHECK(fixture.joint(0) == 1.05);
  CHECK(fixture.controller.state(fixture.now).joints.speed[0] == 0);
  CHECK_FALSE(fixture.controller.next_deadline());
}

TEST_CASE("controller: time and speed of a move, and the shortest one") {
  Fixture fixture;
  fixture.take("movej([1,-1.5708,0,-1.5708,0,0], v=0.5, t=4)");
  CHECK(fixture.controller.next_deadline() == doctest::Approx(4.0));
  fixture.wait(4);
  fixture.take("movej([0,-1.5708,0,-1.5708,0,0], v=0.5)");
  CHECK(fixture.controller.next_deadline() == doctest::Approx(6.0));
  fixture.wait(2);
  fixture.take("movej([0,-1.5708,0,-1.5708,0,0])");
  CHECK(fixture.controller.next_deadline() == doctest::Approx(6.1));
}

TEST_CASE("controller: movel takes its distance, and the tool goes straight there") {
  Fixture fixture;
  fixture.take("movej([0.4, -1.1, 1.3, -1.77, -1.57, 0])");
  fixture.wait(10);
  const Pose start = pose_of(flange_frame(fixture.controller.state(fixture.now).joints.position));
  Pose aim = start;
  aim.values[2] += 0.1;
  std::string script = "movel(p[";
  for (std::size_t i = 0; i < 6; ++i) script += (i == 0 ? "" : ",") + std::to_string(aim.values[i]);
  fixture.take(script + "])");
  CHECK(fixture.controller.next_deadline() == doctest::Approx(fixture.now + 0.4).epsilon(0.001));
  fixture.wait(0.2);
  const Vector half = flange_of(fixture.controller.state(fixture.now).joints.position);
  CHECK(half[2] == doctest::Approx(start.values[2] + 0.05).epsilon(0.001));
  CHECK(half[0] == doctest::Approx(start.values[0]).epsilon(0.001));
  fixture.wait(0.21);
  CHECK(flange_of(fixture.controller.state(fixture.now).joints.position)[2] ==
        doctest::Approx(aim.values[2]).epsilon(0.001));
  CHECK_FALSE(fixture.running());
}

TEST_CASE("controller: a pose out of reach fails at once: movej by an exception with its place, movel by an error") {
  Fixture fixture;
  fixture.take("def far():\n  movej(p[10,0,0,0,0,0])\n  textmsg(\"there\")\nend");
  CHECK(fixture.lines() == Lines{"program far started", "move movej p 10.0000 0.0000 0.0000 0.0000 0.0000 0.0000",
                                 "script_error 2 3 The robot cannot reach the requested pose. Script function movej is "
                                 "unable to find an inverse kinematics solution.",
                                 "program far stopped"});
  fixture.take("movel(p[10,0,0,0,0,0])");
  CHECK(fixture.lines() == Lines{"program unnamed started", "move movel p 10.0000 0.0000 0.0000 0.0000 0.0000 0.0000",
                                 "error C154A0 Position in singularity", "program unnamed stopped"});
  CHECK_FALSE(fixture.running());
  fixture.take("movej([7, 0, 0, 0, 0, 0])");  // a joint turns by one whole turn at most
  CHECK(fixture.lines()[2].starts_with("script_error 1 1 The robot cannot reach"));
  fixture.take(kMoveOne);
  CHECK(fixture.running());
}

TEST_CASE("controller: the tool's centre is what reaches a pose") {
  Fixture fixture;
  fixture.take("movej([0.4, -1.1, 1.3, -1.77, -1.57, 0])");
  fixture.wait(10);
  const Joints before = fixture.controller.state(fixture.now).joints.position;
  const Pose there = pose_of(compose(flange_frame(before), frame_of({{0, 0, 0.1, 0, 0, 0}})));
  std::string script = "def tool():\n  set_tcp(p[0,0,0.1,0,0,0])\n  movej(p[";
  for (std::size_t i = 0; i < 6; ++i) script += (i == 0 ? "" : ",") + std::to_string(there.values[i]);
  fixture.take(script + "])\nend");
  fixture.wait(10);
  CHECK_FALSE(fixture.running());
  for (std::size_t i = 0; i < 6; ++i) CHECK(fixture.joint(i) == doctest::Approx(before[i]).epsilon(0.001));
}

TEST_CASE("controller: the speed slider stretches a move, also one that is under way") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.wait(0.5);
  fixture.controller.set_speed_fraction(0.5, fixture.now);
  CHECK(fixture.controller.next_deadline() == doctest::Approx(1.5));
  CHECK(fixture.controller.state(fixture.now).joints.speed[0] == doctest::Approx(0.525));
  fixture.controller.set_speed_fraction(0, fixture.now);
  CHECK_FALSE(fixture.controller.next_deadline());
  fixture.wait(9);
  CHECK(fixture.joint(0) == doctest::Approx(0.525));
  fixture.controller.set_speed_fraction(1, fixture.now);
  fixture.wait(0.5);
  CHECK(fixture.joint(0) == 1.05);
  CHECK_FALSE(fixture.running());
}

TEST_CASE("controller: a paused program stands, and goes on from there") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.wait(0.5);
  CHECK(fixture.controller.pause(fixture.now));
  fixture.wait(5);
  CHECK(fixture.joint(0) == doctest::Approx(0.525));
  CHECK(fixture.controller.state(fixture.now).program_paused);
  CHECK_FALSE(fixture.running());
  CHECK(fixture.controller.resume(fixture.now));
  CHECK(fixture.controller.next_deadline() == doctest::Approx(6.0));
  fixture.wait(0.5);
  CHECK(fixture.joint(0) == 1.05);
}

TEST_CASE("controller: a program without any duration still starts and stops") {
  Fixture fixture;
  fixture.take("def quick():\n  textmsg(\"hi\")\n  set_digital_out(2, True)\nend");
  CHECK(fixture.lines() == Lines{"program quick started", "text hi", "digital_out 2 on", "program quick stopped"});
}

TEST_CASE("controller: steps follow one another exactly, however late it is called") {
  Fixture fixture;
  fixture.take("def two():\n  sleep(1)\n  textmsg(\"a\")\n  sleep(1)\n  textmsg(\"b\")\nend");
  fixture.wait(1.75);
  CHECK(fixture.controller.next_deadline() == doctest::Approx(2.0));
  fixture.wait(10);
  CHECK(fixture.lines() == Lines{"program two started", "text a", "text b", "program two stopped"});
}

TEST_CASE("controller: a new program replaces the running one, a secondary one does not") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.lines();
  fixture.wait(0.5);
  fixture.take("sec out():\n  set_digital_out(1, False)\nend");
  CHECK(fixture.lines() == Lines{"secondary out", "digital_out 1 off"});
  CHECK(fixture.controller.next_deadline() == doctest::Approx(1.0));
  fixture.take("sleep(1)");
  CHECK(fixture.lines() == Lines{"program one stopped", "program unnamed started"});
  fixture.wait(0.25);
  CHECK(fixture.joint(0) == doctest::Approx(0.525));
}

TEST_CASE("controller: a script with an error changes nothing") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.lines();
  fixture.take("def two():\n  dance()\nend");
  CHECK(fixture.lines() == Lines{"script_error 2 3 compile_error_name_not_found:dance:"});
  CHECK(fixture.running());
}

TEST_CASE("controller: stop program halts the arm where it is") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.lines();
  fixture.wait(0.2);
  fixture.take("stop program");
  CHECK(fixture.lines() == Lines{"program one stopped", "stopped"});
  fixture.wait(5);
  CHECK(fixture.joint(0) == doctest::Approx(0.21));
  CHECK_FALSE(fixture.running());
}

TEST_CASE("controller: power off, power on, run") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.take("power off");
  CHECK(fixture.controller.state(0).mode == RobotMode::power_off);
  CHECK_FALSE(fixture.running());
  fixture.lines();
  fixture.take(kMoveOne);
  CHECK(fixture.lines() ==
        Lines{"error C100A3 robot_not_running", "script_error 1 1 runtime_error_robot_not_running:"});
  fixture.take("power on");
  CHECK(fixture.controller.state(0).mode == RobotMode::idle);
  fixture.take("power off");
  fixture.take("set robotmode run");  // the power first, by itself
  CHECK(fixture.controller.state(0).mode == RobotMode::running);
  fixture.take(kMoveOne);
  CHECK(fixture.running());
}

TEST_CASE("controller: a protective stop ends the program until it is unlocked") {
  Fixture fixture;
  fixture.take(kMoveOne);
  fixture.lines();
  fixture.wait(0.2);
  fixture.controller.set_safety(SafetyMode::protective_stop, fixture.now);
  CHECK(fixture.lines() == Lines{"safety protective_stop", "program one stopped", "stopped"});
  fixture.take(kMoveOne);
  CHECK(fixture.lines().front() == "error C100A103 robot_not_running");
  fixture.wait(4.9);
  fixture.take("set unlock protective stop");
  CHECK(fixture.controller.state(fixture.now).safety == SafetyMode::protective_stop);
  fixture.lines();
  fixture.wait(0.2);
  fixture.take("set unlock protective stop");
  CHECK(fixture.lines() == Lines{"safety normal"});
  fixture.take(kMoveOne);
  CHECK(fixture.running());
}

TEST_CASE("controller: an emergency stop takes the power, and nothing switches it on before it is released") {
  Fixture fixture;
  fixture.controller.set_safety(SafetyMode::emergency_stop, 0);
  CHECK(fixture.controller.state(0).mode == RobotMode::power_off);
  for (const char* line : {"set unlock protective stop", "power on", "set robotmode run"}) fixture.take(line);
  CHECK(fixture.controller.state(0).safety == SafetyMode::emergency_stop);
  CHECK(fixture.controller.state(0).mode == RobotMode::power_off);
  fixture.controller.set_safety(SafetyMode::normal, 0);
  CHECK(fixture.lines() == Lines{"safety estop", "stopped", "safety normal"});
  CHECK(fixture.controller.state(0).mode == RobotMode::power_off);
  fixture.take("set robotmode run");
  CHECK(fixture.controller.state(0).mode == RobotMode::running);
}
