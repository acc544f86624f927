#include <algorithm>
#include <cctype>

#include "services/virtual-robots/arm/six_axis.hpp"
#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/text/dialogue.hpp"

namespace trb::virtual_robots::text {
namespace {

// What RobotMode() tells.
constexpr int kDisabled = 4;
constexpr int kEnabled = 5;
constexpr int kRunning = 7;
constexpr int kError = 9;

// What an answer begins with.
constexpr int kTaken = 0;
constexpr int kNotExecuted = -1;
constexpr int kInAlarm = -2;
constexpr int kNoCommand = -10000;
constexpr int kBadCount = -20000;
constexpr int kBadType = -30001;

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct Outcome {
  int code = kTaken;
  std::string values{};
};

class Dobot : public Dialogue {
 public:
  std::optional<std::string> take(std::string& input) const override {
    const std::size_t bracket = input.find(')');
    if (bracket == std::string::npos) return std::nullopt;
    const std::string request(trim(std::string_view(input).substr(0, bracket + 1)));
    input.erase(0, bracket + 1);
    return request;
  }
  std::string_view end() const override { return ";"; }

  std::string answer(std::uint64_t, const std::string& request, double now) override {
    arm_.advance(now);
    const std::size_t bracket = std::min(request.find('('), request.size() - 1);
    const std::string parameters = request.substr(bracket + 1, request.size() - bracket - 2);
    const Outcome outcome = carry_out(lower(request.substr(0, bracket)), parameters, now);
    return std::to_string(outcome.code) + ",{" + outcome.values + "}," + request;
  }
  void fail(double now) override {
    alarm_ = true;
    arm_.halt(now);
  }
  void clear() override { alarm_ = false; }

 private:
  Outcome carry_out(const std::string& name, const std::string& parameters, double now) {
    if (name == "robotmode") return {kTaken, std::to_string(mode())};
    if (name == "getangle") return {kTaken, joints_text(now)};
    if (name == "clearerror") {
      alarm_ = false;
      return {};
    }
    if (name != "enablerobot" && name != "disablerobot" && name != "stop" && name != "movj") return {kNoCommand};
    if (name == "stop") {
      arm_.halt(now);
      return {};
    }
    if (alarm_) return {kInAlarm};
    if (name == "movj") return move(parameters, now);
    enabled_ = name == "enablerobot";
    if (!enabled_) arm_.halt(now);
    return {};
  }
  Outcome move(const std::string& parameters, double now) {
    if (!enabled_) return {kNotExecuted};
    if (!parameters.starts_with("joint={") || !parameters.ends_with("}")) return {kBadType};
    const auto parts = split(std::string_view(parameters).substr(7, parameters.size() - 8), ',');
    if (parts.size() != arm::kAxes) return {kBadCount};
    arm::Joints joints{};
    for (std::size_t i = 0; i < arm::kAxes; ++i) {
      const auto number = parse_number(trim(parts[i]));
      if (!number) return {kBadType};
      joints[i] = *number;
    }
    arm_.start({joints}, now);
    return {kTaken, std::to_string(++command_)};
  }
  int mode() const {
    if (alarm_) return kError;
    if (!enabled_) return kDisabled;
    return arm_.moving() ? kRunning : kEnabled;
  }
  std::string joints_text(double now) const {
    std::string out;
    for (const double joint : arm_.joints(now)) out += (out.empty() ? "" : ",") + format_fixed(joint, 6);
    return out;
  }

  arm::SixAxis arm_;
  bool enabled_ = false;
  bool alarm_ = false;
  int command_ = 0;
};

}  // namespace

std::unique_ptr<Dialogue> make_dobot() {
  return std::make_unique<Dobot>();
}

}  // namespace trb::virtual_robots::text
