#include "services/virtual-robots/ur/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trb::virtual_robots::ur {
namespace {

constexpr double kTiny = 1e-9;

Vector rotation_vector(const Frame& frame) {
  const double trace = frame.x[0] + frame.y[1] + frame.z[2];
  const double angle = std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
  Vector axis{frame.y[2] - frame.z[1], frame.z[0] - frame.x[2], frame.x[1] - frame.y[0]};
  const double length = std::sqrt(dot(axis, axis));
  if (length > 1e-6) return sum(angle / length, axis, 0, axis);
  if (angle < 1) return {};
  // Half a turn: the axis is what does not move, R + 1 maps everything onto it.
  const std::array<Vector, 3> columns{sum(1, frame.x, 1, {1, 0, 0}), sum(1, frame.y, 1, {0, 1, 0}),
                                      sum(1, frame.z, 1, {0, 0, 1})};
  const auto longest = std::max_element(columns.begin(), columns.end(),
                                        [](const Vector& a, const Vector& b) { return dot(a, a) < dot(b, b); });
  return sum(angle / std::sqrt(dot(*longest, *longest)), *longest, 0, *longest);
}

/** Rodrigues's formula for one vector. */
Vector turned(const Vector& vector, const Vector& axis, double angle) {
  const Vector across = cross(axis, vector);
  const Vector part = sum(std::cos(angle), vector, std::sin(angle), across);
  return sum(1, part, dot(axis, vector) * (1 - std::cos(angle)), axis);
}

}  // namespace

Vector sum(double a, const Vector& x, double b, const Vector& y) {
  return {a * x[0] + b * y[0], a * x[1] + b * y[1], a * x[2] + b * y[2]};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Frame compose(const Frame& outer, const Frame& inner) {
  const auto out = [&](const Vector& v) { return sum(1, sum(v[0], outer.x, v[1], outer.y), v[2], outer.z); };
  return {out(inner.x), out(inner.y), out(inner.z), sum(1, outer.origin, 1, out(inner.origin))};
}

Frame inverse(const Frame& frame) {
  Frame back;
  back.x = {frame.x[0], frame.y[0], frame.z[0]};
  back.y = {frame.x[1], frame.y[1], frame.z[1]};
  back.z = {frame.x[2], frame.y[2], frame.z[2]};
  back.origin = {-dot(frame.x, frame.origin), -dot(frame.y, frame.origin), -dot(frame.z, frame.origin)};
  return back;
}

Frame frame_of(const Pose& pose) {
  Frame frame;
  const Vector turn{pose.values[3], pose.values[4], pose.values[5]};
  const double angle = std::sqrt(dot(turn, turn));
  if (angle > kTiny) {
    const Vector axis = sum(1 / angle, turn, 0, turn);
    frame.x = turned(frame.x, axis, angle);
    frame.y = turned(frame.y, axis, angle);
    frame.z = turned(frame.z, axis, angle);
  }
  frame.origin = {pose.values[0], pose.values[1], pose.values[2]};
  return frame;
}

Pose pose_of(const Frame& frame) {
  const Vector turn = rotation_vector(frame);
  return {{frame.origin[0], frame.origin[1], frame.origin[2], turn[0], turn[1], turn[2]}};
}

Pose pose_between(const Pose& from, const Pose& to, double fraction) {
  const Frame start = frame_of(from);
  const Frame end = frame_of(to);
  Frame turn_only = compose(inverse(start), end);
  turn_only.origin = {};
  Pose part = pose_of(turn_only);
  for (double& value : part.values) value *= fraction;
  Frame at = compose({start.x, start.y, start.z, {}}, frame_of(part));
  at.origin = sum(1 - fraction, start.origin, fraction, end.origin);
  return pose_of(at);
}

double way_between(const Pose& from, const Pose& to) {
  return std::hypot(to.values[0] - from.values[0], to.values[1] - from.values[1], to.values[2] - from.values[2]);
}

double turn_between(const Pose& from, const Pose& to) {
  const Vector turn = rotation_vector(compose(inverse(frame_of(from)), frame_of(to)));
  return std::sqrt(dot(turn, turn));
}

}  // namespace trb::virtual_robots::ur
