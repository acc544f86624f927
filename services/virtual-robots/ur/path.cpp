#include "services/virtual-robots/ur/path.hpp"

#include <algorithm>
#include <cmath>

namespace trb::virtual_robots::ur {
namespace {

/** A straight line is cut into pieces of so many metres and radians, but not into more than this. */
constexpr double kPiece = 0.005;
constexpr double kTurnPiece = 0.02;
constexpr int kMostPieces = 500;
/** A joint that would turn farther than this within a piece passes a singularity. */
constexpr double kJump = 0.5;

double duration_of(double way, const MoveStep& step, double default_speed, double shortest) {
  if (step.time > 0) return std::max(step.time, shortest);
  return std::max(way / (step.speed > 0 ? step.speed : default_speed), shortest);
}

double farthest_turn(const Joints& a, const Joints& b) {
  double farthest = 0;
  for (std::size_t i = 0; i < kJointCount; ++i) farthest = std::max(farthest, std::abs(b[i] - a[i]));
  return farthest;
}

std::optional<Joints> joints_at(const Pose& pose, const Joints& near, const Frame& tool) {
  return joints_for(compose(frame_of(pose), inverse(tool)), near);
}

std::optional<Path> by_joints(const MoveStep& step, const Joints& from, const Frame& tool) {
  const auto* joints = std::get_if<Joints>(&step.target);
  const auto to = joints != nullptr ? std::optional(*joints) : joints_at(std::get<Pose>(step.target), from, tool);
  const auto within = [](double joint) { return std::abs(joint) <= kJointLimit + 1e-3; };
  if (!to || !std::all_of(to->begin(), to->end(), within)) return std::nullopt;
  return Path{{from, *to}, duration_of(farthest_turn(from, *to), step, kDefaultJointSpeed, kShortestJointMove)};
}

std::optional<Path> by_line(const MoveStep& step, const Joints& from, const Frame& tool) {
  const auto tcp = [&](const Joints& joints) { return pose_of(compose(flange_frame(joints), tool)); };
  const auto* joints = std::get_if<Joints>(&step.target);
  const Pose start = tcp(from);
  const Pose end = joints != nullptr ? tcp(*joints) : std::get<Pose>(step.target);
  const double way = way_between(start, end), turn = turn_between(start, end);
  // Whether the end can be reached at all is known before a long way is cut into pieces.
  if (!joints_at(end, from, tool)) return std::nullopt;
  const int pieces = std::clamp(static_cast<int>(std::max(way / kPiece, turn / kTurnPiece)) + 1, 1, kMostPieces);
  Path path{{from}, duration_of(way, step, kDefaultToolSpeed, kShortestToolMove)};
  path.duration = std::max(path.duration, step.time > 0 ? 0 : turn / kDefaultJointSpeed);
  for (int i = 1; i <= pieces; ++i) {
    const Pose pose = i == pieces ? end : pose_between(start, end, double(i) / pieces);
    const auto next = joints_at(pose, path.points.back(), tool);
    if (!next || farthest_turn(path.points.back(), *next) > kJump) return std::nullopt;
    path.points.push_back(*next);
  }
  return path;
}

}  // namespace

std::optional<Path> path_of(const MoveStep& step, const Joints& from, const Frame& tool) {
  return step.function == "movel" ? by_line(step, from, tool) : by_joints(step, from, tool);
}

}  // namespace trb::virtual_robots::ur
