#include "services/virtual-robots/arm/six_axis.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::arm;

TEST_CASE("an arm moves straight in time, and its pose follows") {
  SixAxis arm;
  const Pose before = arm.pose(0);
  arm.start({Joints{60, -90, 90, 0, 0, 0}}, 10);
  CHECK(*arm.next_deadline() == doctest::Approx(11));
  CHECK(arm.joints(10.5)[0] == doctest::Approx(30));
  CHECK(arm.pose(10.5).y > before.y + 100);
  CHECK_FALSE(arm.advance(10.9));
  CHECK(arm.advance(11));
  CHECK_FALSE(arm.moving());
  CHECK(arm.joints(12)[0] == doctest::Approx(60));
}

TEST_CASE("steps follow each other without adding up lateness") {
  SixAxis arm;
  arm.start(pick_steps({60, -90, 90, 0, 0, 0}), 0);
  CHECK_FALSE(arm.advance(1.2));
  CHECK(arm.gripper_closed());
  CHECK(*arm.next_deadline() == doctest::Approx(1.5));
  CHECK(arm.advance(99));
  CHECK(arm.joints(99)[0] == doctest::Approx(0));
}

TEST_CASE("a halted arm stands where it was; a paused one goes on") {
  SixAxis arm;
  arm.start({Joints{60, -90, 90, 0, 0, 0}}, 0);
  arm.pause(0.5);
  CHECK_FALSE(arm.advance(5));
  CHECK(arm.joints(5)[0] == doctest::Approx(30));
  arm.resume(6);
  CHECK(arm.advance(6.5));
  arm.start({Pose{500, 100, 400, 0, 0, 180}}, 10);
  arm.halt(10.01);
  CHECK_FALSE(arm.next_deadline());
  CHECK(arm.pose(20).x == doctest::Approx(arm.pose(10.01).x));
  CHECK(arm.pose(20).x != doctest::Approx(500));
}

TEST_CASE("joints out of their range are named") {
  CHECK_FALSE(out_of_range(kHome));
  CHECK(*out_of_range({0, 60, 90, 0, 0, 0}) == "A2 60.0 is not in -190.0..45.0");
}
