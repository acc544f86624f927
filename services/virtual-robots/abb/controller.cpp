#include "services/virtual-robots/abb/controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::abb {
namespace {

/** The controller's number for a motion that was given up. */
constexpr int kMotionError = 50204;

arm::Joints joints_of(const std::vector<double>& numbers) {
  arm::Joints out{};
  std::copy_n(numbers.begin(), arm::kAxes, out.begin());
  return out;
}

std::string list(const std::vector<double>& numbers, int decimals) {
  std::string out;
  for (const double number : numbers) out += (out.empty() ? "" : " ") + format_fixed(number, decimals);
  return out;
}

}  // namespace

std::optional<std::string> Controller::program(const std::string& text, double now) {
  const Request request = parse(text);
  const int code = request.code;
  events_.push_back("request " + escape_line(text));
  const auto bad = [&](const std::string& why) { return answer(code, false, escape(why)); };
  if (!request.well_formed) return bad("no end of the request within 80 characters");
  const auto six = numbers(request, 6);
  switch (code) {
    case 0:
      return answer(0, true, "");
    case 1: {
      const auto pose = numbers(request, 8);
      if (!pose) return bad("a pose has 8 numbers");
      return move(request, {arm::Pose{(*pose)[0], (*pose)[1], (*pose)[2], 0, 0, 180}}, now);
    }
    case 2: {
      if (!six) return bad("6 joints are needed, " + std::to_string(request.parameters.size()) + " were given");
      const auto out = arm::out_of_range(joints_of(*six), arm::kAbbRanges, 'J');
      if (out) return bad(*out);
      return move(request, {joints_of(*six)}, now);
    }
    case 3:
      return answer(3, true, pose_text(now));
    case 4:
      return answer(4, true, joints_text(now));
    case 10: {
      const auto place = numbers(request, 4);
      if (!place) return bad("x, y, z and a direction are needed");
      return move(request, {arm::Pose{(*place)[0], (*place)[1], (*place)[2], (*place)[3], 0, 180}}, now);
    }
    case 20:
      if (!numbers(request, 1)) return bad("1 or 0 is needed");
      return move(request, {arm::Grip{request.parameters.front() == "1"}}, now);
    case 40: {
      std::string shown;
      for (const std::string& parameter : request.parameters) shown += (shown.empty() ? "" : " ") + unescape(parameter);
      events_.push_back("text " + escape_line(shown));
      return answer(40, true, "");
    }
    default:
      return bad("unknown request");
  }
}

std::optional<std::string> Controller::move(const Request& request, std::vector<arm::Step> steps, double now) {
  if (!motors_) return answer(request.code, false, escape("motors off"));
  if (stopped_) return answer(request.code, false, escape("stopped"));
  if (fails(request.code)) return answer(request.code, false, escape("injected failure"));
  moving_ = request.code;
  if (request.code == 20) events_.push_back(request.parameters.front() == "1" ? "gripper closed" : "gripper open");
  events_.push_back("start " + std::to_string(request.code));
  arm_.start(std::move(steps), now);
  return std::nullopt;
}

std::string Controller::service(const std::string& text, double now) {
  const Request request = parse(text);
  switch (request.well_formed ? request.code : -1) {
    case 3:
      return answer(3, true, pose_text(now));
    case 4:
      return answer(4, true, joints_text(now));
    case 90:
      return answer(90, true, state_text());
    case 91:
      if (!stopped_) events_.push_back("stopped");
      stopped_ = true;
      arm_.halt(now);
      return answer(91, true, "");
    case 92:
      if (stopped_) events_.push_back("released");
      stopped_ = false;
      return answer(92, true, "");
    default:
      return answer(request.code, false, escape("unknown request"));
  }
}

std::optional<std::string> Controller::advance(double now) {
  if (arm_.advance(now)) return moving_ ? std::optional(end_move(true, "")) : std::nullopt;
  if (moving_ && stopped_) return end_move(false, "stopped");
  return std::nullopt;
}

std::string Controller::end_move(bool ok, const std::string& text) {
  const int code = *std::exchange(moving_, std::nullopt);
  events_.push_back((ok ? "done " : "failed ") + std::to_string(code) + (text.empty() ? "" : " " + escape_line(text)));
  return answer(code, ok, text.empty() ? "" : escape(text));
}

std::optional<std::string> Controller::raise_fault(const std::string& capability, const std::string& severity,
                                                   const std::string& text, double now) {
  error_ = kMotionError;
  error_text_ = capability + " " + severity + " " + text;
  events_.push_back("fault " + capability + " " + severity);
  if (severity == "WARNING") return std::nullopt;
  motors_ = false;
  arm_.halt(now);
  return moving_ ? std::optional(end_move(false, text)) : std::nullopt;
}

void Controller::clear() {
  motors_ = true;
  error_ = 0;
  error_text_.clear();
  events_.push_back("cleared");
}

bool Controller::fails(int code) {
  bool fails = false;
  for (std::size_t i = 0; i < failures_.size(); ++i) {
    if (failures_[i].code != code) continue;
    ++calls_[i];
    fails = fails || !failures_[i].call || *failures_[i].call == calls_[i];
  }
  return fails;
}

std::string Controller::joints_text(double now) const {
  const arm::Joints joints = arm_.joints(now);
  return list({joints.begin(), joints.end()}, 2);
}

/** Position and, for the direction about the vertical axis with the tool down, a quaternion. */
std::string Controller::pose_text(double now) const {
  const arm::Pose pose = arm_.pose(now);
  const double half = pose.a * M_PI / 360;
  return list({pose.x, pose.y, pose.z}, 2) + " " + list({0, std::cos(half), std::sin(half), 0}, 3);
}

std::string Controller::state_text() const {
  return std::string(stopped_ ? "1" : "0") + (moving_ ? " 1" : " 0") + (motors_ ? " 1 " : " 0 ") +
         std::to_string(error_) + (error_ == 0 ? "" : " " + escape(error_text_));
}

std::vector<std::string> Controller::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::abb
