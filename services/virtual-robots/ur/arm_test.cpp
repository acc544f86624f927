#include "services/virtual-robots/ur/arm.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace trb::virtual_robots::ur;

namespace {

constexpr Joints kBent{0.4, -1.1, 1.3, -1.77, -1.57, 0};

Arm bent() {
  Arm arm;
  arm.start({"movej", kBent, 0, 0.1}, 0);
  return arm;
}

/** How far the flange has moved, by axis. */
std::array<double, 3> way(const Arm& arm, double from, double to) {
  const auto before = flange_of(arm.at(from).position);
  const auto after = flange_of(arm.at(to).position);
  return {after[0] - before[0], after[1] - before[1], after[2] - before[2]};
}

}  // namespace

TEST_CASE("arm: joints run at a speed, after a ramp, as long as nothing else is said") {
  Arm arm;
  const double start = arm.at(0).position[2];
  CHECK(arm.run({"speedj", {0, 0, 0.5, 0, 0, 0}, 1, 0.5}, 0) == 0.5);
  CHECK(arm.at(0.25).speed[2] == doctest::Approx(0.25));
  CHECK(arm.at(0.5).position[2] - start == doctest::Approx(0.125));
  CHECK(arm.at(1.5).position[2] - start == doctest::Approx(0.625));
  arm.settle(1.5);
  CHECK(arm.at(2.5).position[2] - start == doctest::Approx(1.125));
  CHECK(Arm().run({"speedj", {0, 0, 0.5, 0, 0, 0}, 1, 0}, 0) == 0.5);  // without a time: until the speed is reached
}

TEST_CASE("arm: a newer speed takes over from the present one, and a brake ends it") {
  Arm arm;
  arm.run({"speedj", {0.5, 0, 0, 0, 0, 0}, 1, 0.5}, 0);
  arm.halt(1);  // the program is replaced
  arm.run({"speedj", {0.5, 0, 0, 0, 0, 0}, 1, 0.5}, 1);
  CHECK(arm.at(1.1).speed[0] == doctest::Approx(0.5));
  CHECK(arm.brake(2, 1.1) == doctest::Approx(1.35));
  const double stands = arm.at(1.35).position[0];
  CHECK(arm.at(9).position[0] == doctest::Approx(stands));
  CHECK(arm.at(9).speed[0] == 0);
  CHECK(arm.brake(2, 9) == 9);
}

TEST_CASE("arm: the end of a program brakes a motion by speed, and a move goes on from there") {
  Arm arm;
  arm.run({"speedj", {0.4, 0, 0, 0, 0, 0}, 4, 0.5}, 0);
  arm.halt(0.5);
  CHECK(arm.at(0.7).position[0] == doctest::Approx(0.02 + 0.16 + 0.02));
  CHECK(arm.start({"movej", Joints{}, 0, 1}, 1));
  CHECK(arm.end() == 2);
  CHECK(arm.at(2).position[0] == 0);
}

TEST_CASE("arm: where the flange of a UR3 is") {
  const auto up = flange_of({0, -std::acos(0.0), 0, -std::acos(0.0), 0, 0});  // as its maker shows it
  CHECK(up[0] == doctest::Approx(0).epsilon(1e-3));
  CHECK(up[1] == doctest::Approx(-0.19425).epsilon(1e-3));
  CHECK(up[2] == doctest::Approx(0.69415).epsilon(1e-3));
}

TEST_CASE("arm: the tool moves at a speed along an axis of the foot, and along no other") {
  Arm arm = bent();
  arm.run({"speedl", {0, 0, 0.05, 0, 0, 0}, 0.5, 0.5}, 1);
  const auto up = way(arm, 1.1, 2.1);
  CHECK(up[2] == doctest::Approx(0.05).epsilon(0.01));
  CHECK(std::abs(up[0]) < 1e-4);
  CHECK(std::abs(up[1]) < 1e-4);
  arm.run({"speedl", {0.05, 0, 0, 0, 0, 0}, 0.5, 0.5}, 2.1);
  CHECK(way(arm, 2.4, 3.4)[0] == doctest::Approx(0.05).epsilon(0.01));
  arm.brake(1, 3.4);
  CHECK(std::abs(way(arm, 3.5, 9)[0]) < 1e-6);
}

TEST_CASE("arm: stretched out, no joint exceeds what a joint can do") {
  Arm arm;  // straight up: it cannot go further up
  arm.run({"speedl", {0, 0, 0.2, 0, 0, 0}, 0.5, 0.5}, 0);
  for (int tenths = 0; tenths < 20; ++tenths) {
    for (const double speed : arm.at(tenths * 0.1).speed) CHECK(std::abs(speed) <= 3.1416);
  }
}
