#include "services/virtual-robots/lines/body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::lines {
namespace {

constexpr double kSpeed = 1.0;
constexpr double kShortestDrive = 0.2;
constexpr double kSecondsPerPercent = 60.0;

/** The angle from one yaw to another, the shorter way. */
double turn(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

Pose between(const Pose& from, const Pose& to, double share) {
  return {from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share,
          from.yaw + turn(from.yaw, to.yaw) * share};
}

std::string format_percent(double percent) {
  std::string text = format_fixed(percent, 1);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

}  // namespace

std::optional<Pose> parse_pose(std::string_view text, char separator) {
  const std::vector<std::string> parts = split(trim(text), separator);
  if (parts.size() != 3) return std::nullopt;
  const auto x = parse_number(parts[0]), y = parse_number(parts[1]), yaw = parse_number(parts[2]);
  if (!x || !y || !yaw) return std::nullopt;
  return Pose{*x, *y, *yaw};
}

std::string format_pose(const Pose& pose) {
  return format_fixed(pose.x, 3) + " " + format_fixed(pose.y, 3) + " " + format_fixed(pose.yaw, 3);
}

std::string_view reason_text(Reason reason) {
  switch (reason) {
    case Reason::busy:
      return "busy";
    case Reason::stopped:
      return "stopped";
    case Reason::injected:
      return "injected failure";
    case Reason::bad_data:
      return "bad data";
  }
  return "unknown";
}

void Body::take(const Message& message, double now) {
  advance(now);
  if (message.type == "command" && knows(message.subtype)) command(message, now);
  if (message.type == "request") request(message, now);
}

void Body::command(const Message& message, double now) {
  const std::string& skill = message.subtype;
  if (stopped_) return emit(Failed{skill, Reason::stopped});
  if (run_) return emit(Failed{skill, Reason::busy});
  if (fails(skill)) return emit(Failed{skill, Reason::injected});
  if (skill == "go_to") {
    const auto goal = parse_pose(message.data, ' ');
    if (!goal) return emit(Failed{skill, Reason::bad_data});
    to_ = *goal;
  }
  run_ = Run{skill, now, now + duration_of(skill)};
  emit(Started{skill, message.data});
}

void Body::request(const Message& message, double now) {
  std::string data = "unknown";
  if (message.subtype == "position") data = format_pose(pose(now));
  if (message.subtype == "battery") data = format_percent(battery(now));
  if (message.subtype == "echo") data = message.data;
  emit(Answer{message.subtype, message.peer, data});
}

/** Counts only the calls that could begin, so that `--fail skill:2` means the second real attempt. */
bool Body::fails(const std::string& skill) {
  const int call = ++calls_[skill];
  const auto found = settings_.failures.find(skill);
  return found != settings_.failures.end() && (found->second.empty() || found->second.contains(call));
}

double Body::duration_of(const std::string& skill) const {
  const auto found = settings_.skills.find(skill);
  if (found != settings_.skills.end()) return found->second;
  return std::max(std::hypot(to_.x - from_.x, to_.y - from_.y) / kSpeed, kShortestDrive);
}

void Body::stop(double now) {
  advance(now);
  stopped_ = true;
  if (!run_) return;
  const std::string skill = run_->skill;
  halt(now);
  emit(Failed{skill, Reason::stopped});
}

void Body::advance(double now) {
  if (!run_ || now < run_->end) return;
  const std::string skill = run_->skill;
  halt(run_->end);
  emit(Done{skill});
}

void Body::halt(double now) {
  from_ = to_ = pose(now);
  worked_ += now - run_->begin;
  run_.reset();
}

std::optional<double> Body::next_deadline() const {
  if (!run_) return std::nullopt;
  return run_->end;
}

Pose Body::pose(double now) const {
  if (!run_ || run_->skill != "go_to") return from_;
  if (now >= run_->end) return to_;
  return between(from_, to_, std::clamp((now - run_->begin) / (run_->end - run_->begin), 0.0, 1.0));
}

double Body::battery(double now) const {
  const double worked = worked_ + (run_ ? std::min(now, run_->end) - run_->begin : 0.0);
  return std::max(0.0, settings_.battery - worked / kSecondsPerPercent);
}

}  // namespace trb::virtual_robots::lines
