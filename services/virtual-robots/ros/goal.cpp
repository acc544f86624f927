#include "services/virtual-robots/ros/goal.hpp"

#include <cmath>

namespace trb::virtual_robots::ros {
namespace {

// As move_base judges: below this square of a length a quaternion is no rotation; its z axis may lean that much.
constexpr double kNoLength = 1e-6;
constexpr double kLeans = 1e-3;

bool is_finite(const SentPose& sent) {
  for (const double number : {sent.x, sent.y, sent.z, sent.qx, sent.qy, sent.qz, sent.qw}) {
    if (!std::isfinite(number)) return false;
  }
  return true;
}

double square_length(const SentPose& sent) {
  return sent.qx * sent.qx + sent.qy * sent.qy + sent.qz * sent.qz + sent.qw * sent.qw;
}

/** How far its z axis is from the vertical: 1 less the axis' height. */
double lean(const SentPose& sent) {
  return 2 * (sent.qx * sent.qx + sent.qy * sent.qy) / square_length(sent);
}

std::string fault_of(const SentPose& sent) {
  if (!is_finite(sent)) return "a number is not finite";
  if (square_length(sent) < kNoLength) return "the quaternion has no length";
  if (!std::isfinite(square_length(sent))) return "the quaternion is too long";
  return lean(sent) > kLeans ? "the quaternion's z axis is not vertical" : "";
}

Pose moved(const Pose& by, const Pose& pose) {
  return {by.x + pose.x * std::cos(by.yaw) - pose.y * std::sin(by.yaw),
          by.y + pose.x * std::sin(by.yaw) + pose.y * std::cos(by.yaw), std::remainder(by.yaw + pose.yaw, 2 * M_PI)};
}

}  // namespace

Goal goal_in_map(const std::string& frame, const SentPose& sent, const Pose& here) {
  if (const std::string fault = fault_of(sent); !fault.empty()) return {{}, fault};
  const Pose pose{sent.x, sent.y, std::remainder(2 * std::atan2(sent.qz, sent.qw), 2 * M_PI)};
  if (frame == "map" || frame == "odom") return {pose, {}};
  if (frame == "base_link") return {moved(here, pose), {}};
  return {{}, "no transform from frame '" + frame + "' to 'map'"};
}

}  // namespace trb::virtual_robots::ros
