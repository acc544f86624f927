#include "common/drivers/arcos/journey.hpp"

#include <algorithm>
#include <cmath>

#include "common/drivers/arcos/packet.hpp"
#include "common/drivers/text/number_text.hpp"

namespace trb::drivers {
namespace {

constexpr std::uint8_t kMove = 8;
constexpr std::uint8_t kHead = 12;
constexpr double kLongestMove = 5000;  ///< mm, ARCOS's limit
constexpr double kWorthATurn = 2;      ///< degrees: less is corrected by the next leg
constexpr double kTowards = 5;         ///< degrees: with a greater error it does not drive yet
constexpr int kCorrections = 8;
constexpr double kSomeWay = 10;  ///< mm
constexpr double kSomeTurn = 1;  ///< degrees
constexpr Duration kNoProgress = std::chrono::seconds(3);
/// A robot that stands for this long after an order to move has received it and has ended.
constexpr Duration kSettled = std::chrono::milliseconds(300);

double way_between(const ArcosPose& a, const ArcosPose& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

double turn_between(double from, double to) {
  return std::remainder(to - from, 360);
}

std::string rounded(double number) {
  return number_text(std::round(number));
}

}  // namespace

ArcosJourney::Next ArcosJourney::on_pose(const ArcosPose& pose, bool stands, MonotonicTime now) {
  if (leg_ == Leg::none) {
    if (!stands) return {};
    const double distance = std::hypot(goal_.x - pose.x, goal_.y - pose.y);
    legs_left_ = kCorrections + 2 * static_cast<int>(std::min(distance / kLongestMove, 1000.0));
    return begin_leg(pose, now);
  }
  note_progress(pose, now);
  if (now - progressed_ >= kNoProgress) return fail("no progress for 3 s", pose);
  if (!stands || now - leg_began_ < kSettled || !done(pose)) return {};
  if (leg_ == Leg::face) return {{}, true, {}};
  return begin_leg(pose, now);
}

ArcosJourney::Next ArcosJourney::begin_leg(const ArcosPose& pose, MonotonicTime now) {
  const double east = goal_.x - pose.x;
  const double north = goal_.y - pose.y;
  const double distance = std::hypot(east, north);
  if (distance <= goal_.tolerance) {
    if (!goal_.heading || std::abs(turn_between(pose.heading, *goal_.heading)) <= goal_.angle) return {{}, true, {}};
    return turn(Leg::face, *goal_.heading, pose, now);
  }
  if (legs_left_-- == 0) return fail("not there after all corrections", pose);
  const double bearing = std::atan2(north, east) * 180 / M_PI;
  const double off = std::abs(turn_between(pose.heading, bearing));
  if (off > (leg_ == Leg::turn ? kTowards : kWorthATurn)) return turn(Leg::turn, bearing, pose, now);
  start(Leg::drive, pose, now);
  return {arcos_command(kMove, static_cast<int>(std::round(std::min(distance, kLongestMove)))), false, {}};
}

ArcosJourney::Next ArcosJourney::turn(Leg leg, double heading, const ArcosPose& pose, MonotonicTime now) {
  towards_ = heading;
  start(leg, pose, now);
  return {arcos_command(kHead, static_cast<int>(std::round(std::remainder(heading, 360)))), false, {}};
}

void ArcosJourney::start(Leg leg, const ArcosPose& pose, MonotonicTime now) {
  leg_ = leg;
  began_ = progress_ = pose;
  leg_began_ = progressed_ = now;
}

bool ArcosJourney::done(const ArcosPose& pose) const {
  if (leg_ == Leg::drive) return way_between(began_, pose) >= kSomeWay;
  return std::abs(turn_between(pose.heading, towards_)) <= (leg_ == Leg::face ? goal_.angle : kTowards);
}

void ArcosJourney::note_progress(const ArcosPose& pose, MonotonicTime now) {
  const bool moved =
      way_between(progress_, pose) >= kSomeWay || std::abs(turn_between(progress_.heading, pose.heading)) >= kSomeTurn;
  if (!moved) return;
  progress_ = pose;
  progressed_ = now;
}

ArcosJourney::Next ArcosJourney::fail(const std::string& why, const ArcosPose& pose) const {
  const double left = std::hypot(goal_.x - pose.x, goal_.y - pose.y);
  return {{},
          true,
          why + ": at " + rounded(pose.x) + ", " + rounded(pose.y) + " mm, heading " + rounded(pose.heading) +
              " degrees, " + rounded(left) + " mm from the goal"};
}

}  // namespace trb::drivers
