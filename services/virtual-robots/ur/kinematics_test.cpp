#include "services/virtual-robots/ur/kinematics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "services/virtual-robots/ur/path.hpp"

using namespace trb::virtual_robots::ur;

namespace {

void check_same(const Frame& a, const Frame& b) {
  const auto near = [](const Vector& x, const Vector& y) {
    for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(x[i] - y[i]) < 1e-6);
  };
  near(a.x, b.x);
  near(a.y, b.y);
  near(a.z, b.z);
  near(a.origin, b.origin);
}

}  // namespace

TEST_CASE("kinematics: the joints of a pose bring the flange there, and those near the arm are taken") {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> angle(-3.1, 3.1);
  int exact = 0;
  for (int i = 0; i < 300; ++i) {
    Joints joints{};
    for (double& joint : joints) joint = angle(random);
    const Frame flange = flange_frame(joints);
    const auto found = joints_for(flange, joints);
    REQUIRE(found);
    check_same(flange_frame(*found), flange);
    const auto elsewhere = joints_for(flange, {});
    REQUIRE(elsewhere);
    check_same(flange_frame(*elsewhere), flange);
    double far = 0;
    for (std::size_t k = 0; k < kJointCount; ++k) far = std::max(far, std::abs((*found)[k] - joints[k]));
    exact += far < 1e-5;
  }
  CHECK(exact == 300);
}

TEST_CASE("kinematics: stretched out and with parallel wrists there is a solution, beyond the reach there is none") {
  const Joints up{0, -std::numbers::pi / 2, 0, -std::numbers::pi / 2, 0, 0};
  const auto found = joints_for(flange_frame(up), up);
  REQUIRE(found);
  check_same(flange_frame(*found), flange_frame(up));
  for (const double x : {10.0, 0.7, -0.7}) CHECK_FALSE(joints_for(frame_of({{x, 0, 0.2, 0, 0, 0}}), up));
  CHECK_FALSE(joints_for(frame_of({{0, 0, 0.2, 0, 0, 0}}), up));  // inside the foot
  CHECK_FALSE(joints_for(frame_of({{std::nan(""), 0, 0.2, 0, 0, 0}}), up));
}

TEST_CASE("geometry: a pose is the frame it was made from, half a turn included") {
  constexpr double kPi = std::numbers::pi;
  for (const Pose& pose : {Pose{{0.1, -0.2, 0.3, 0.4, -0.5, 0.6}}, Pose{{0, 0, 0, kPi, 0, 0}},
                           Pose{{1, 2, 3, 0, -kPi / std::sqrt(2), kPi / std::sqrt(2)}}, Pose{}}) {
    check_same(frame_of(pose_of(frame_of(pose))), frame_of(pose));
    check_same(compose(frame_of(pose), inverse(frame_of(pose))), Frame{});
  }
  const Pose half = pose_between({{0, 0, 0, 0, 0, 0}}, {{1, 0, 0, 0, 0, 1}}, 0.5);
  CHECK(half.values[0] == 0.5);
  CHECK(half.values[5] == doctest::Approx(0.5));
  CHECK(turn_between({{0, 0, 0, 0, 0, 0}}, {{1, 0, 0, 0, 0, 1}}) == doctest::Approx(1));
}

TEST_CASE("path: a line that leaves the reach on its way is refused as a whole") {
  const Joints bent{0.4, -1.1, 1.3, -1.77, -1.57, 0};
  Pose aim = pose_of(flange_frame(bent));
  aim.values[0] = -aim.values[0];
  aim.values[1] = -aim.values[1];  // through the foot
  CHECK_FALSE(path_of({"movel", aim, 0, 0}, bent, {}));
  CHECK(path_of({"movej", aim, 0, 0}, bent, {}));
}
