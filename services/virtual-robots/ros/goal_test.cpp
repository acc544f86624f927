// A goal as move_base's clients send it: frames, and what is no pose.
#include "services/virtual-robots/ros/goal.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace trb::virtual_robots;
using namespace trb::virtual_robots::ros;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const Pose kHere{2, 1, M_PI / 2};

std::string refusal(const SentPose& sent, const std::string& frame = "map") {
  return goal_in_map(frame, sent, kHere).refused;
}

}  // namespace

TEST_CASE("a goal of the map or of odometry is taken as it is, one of the robot's own frame from where it stands") {
  const SentPose sent{3, 0.5, 0, 0, 0, 0, 1};
  CHECK(goal_in_map("map", sent, kHere).pose.x == 3);
  CHECK(goal_in_map("odom", sent, kHere).pose.y == 0.5);
  const Goal own = goal_in_map("base_link", sent, kHere);
  CHECK(own.refused.empty());
  CHECK(own.pose.x == doctest::Approx(1.5));
  CHECK(own.pose.y == doctest::Approx(4));
  CHECK(own.pose.yaw == doctest::Approx(M_PI / 2));
}

TEST_CASE("a frame that the robot does not know is refused, also an empty one and one with a slash") {
  for (const char* frame : {"", "/map", "kitchen", "Map"}) {
    CAPTURE(frame);
    CHECK(refusal({1, 1, 0, 0, 0, 0, 1}, frame) == "no transform from frame '" + std::string(frame) + "' to 'map'");
  }
}

TEST_CASE("a quaternion of any length but none is a turn, as long as the robot stays upright") {
  CHECK(goal_in_map("map", {0, 0, 0, 0, 0, 2, 2}, kHere).pose.yaw == doctest::Approx(M_PI / 2));
  CHECK(refusal({0, 0, 0, 0, 0, 0.0011, 0}).empty());
  CHECK(refusal({0, 0, 0, 0, 0, 0, 0}) == "the quaternion has no length");
  CHECK(refusal({0, 0, 0, 0, 0, 0.0009, 0}) == "the quaternion has no length");
  CHECK(refusal({0, 0, 0, 0, 0, 1e300, 0}) == "the quaternion is too long");
  CHECK(refusal({0, 0, 0, 0.01, 0, 0, 1}).empty());
  CHECK(refusal({0, 0, 0, 0.1, 0, 0, 1}) == "the quaternion's z axis is not vertical");
}

TEST_CASE("a number that is not finite is refused wherever it stands") {
  for (double SentPose::*member :
       {&SentPose::x, &SentPose::y, &SentPose::z, &SentPose::qx, &SentPose::qy, &SentPose::qz, &SentPose::qw}) {
    for (const double bad : {kNan, kInf, -kInf}) {
      SentPose sent{0, 0, 0, 0, 0, 0, 1};
      sent.*member = bad;
      CHECK(refusal(sent) == "a number is not finite");
    }
  }
}
