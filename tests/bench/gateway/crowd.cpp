#include "tests/bench/gateway/crowd.hpp"

#include <cmath>
#include <cstdio>

namespace trb::bench {
namespace {

constexpr int kRow = 40;            // robots beside each other
constexpr double kSpace_m = 2;      // between two
constexpr double kRadius_m = 0.8;   // of a robot's circle
constexpr double kStep_rad = 0.05;  // from change to change

}  // namespace

Crowd::Crowd(int robots, double changes, MonotonicTime begin)
    : robots_(robots), between_ns_(1e9 / (robots * changes)), begin_(begin) {}

MonotonicTime Crowd::due(std::uint64_t index) const {
  return begin_ + Duration{static_cast<std::int64_t>(between_ns_ * static_cast<double>(index))};
}

bool Crowd::take(MonotonicTime now, Change& out) {
  const MonotonicTime next = next_due();
  if (now < next) return false;
  const auto robots = static_cast<std::uint64_t>(robots_);
  out = {static_cast<int>(taken_ % robots), taken_ / robots + 1, next};
  ++taken_;
  return true;
}

std::string Crowd::name(int robot) {
  char text[32];
  std::snprintf(text, sizeof text, "robot-%04d", robot);
  return text;
}

NodeProfile Crowd::profile(int robot) {
  NodeProfile out;
  out.framework = "lines";
  out.mode = "interpreter";
  out.transport = "lines";
  out.maker = "bench";
  out.model = "circler";
  out.capabilities = {"mobile"};
  out.sensors = {"battery", "position", "said"};
  out.robot = "ONLINE";
  const int row = robot / kRow;
  out.frame = {1, (robot % kRow) * kSpace_m, row * kSpace_m, 0};
  return out;
}

std::string Crowd::position(int robot, std::uint64_t number) {
  const double angle = robot + static_cast<double>(number) * kStep_rad;
  char text[96];
  std::snprintf(text, sizeof text, "%.3f %.3f %.3f", kRadius_m * std::cos(angle), kRadius_m * std::sin(angle),
                std::remainder(angle, 6.283185307179586));
  return text;
}

RobotState Crowd::state(const Change& change) {
  const std::string said =
      std::to_string(change.robot) + ' ' + std::to_string(change.number) + ' ' + std::to_string(change.due.ns / 1000);
  return {{{"position", '"' + position(change.robot, change.number) + '"'},
           {"battery", std::to_string(100 - change.number / 100 % 80)},
           {"said", '"' + said + '"'}}};
}

}  // namespace trb::bench
