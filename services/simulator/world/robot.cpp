#include "services/simulator/world/robot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trb::world {
namespace {

constexpr std::size_t kFields = 5;

}  // namespace

void Robot::connect(std::function<void(std::string)> tell) {
  tell_ = std::move(tell);
  line_.clear();
  field_ = 0;
  if (tell_ && broken_) inform_of_fault();
  if (tell_ && owes_end_of_fault_) inform_of_repair();
  if (tell_ && battery_) inform_of_charge();
}

void Robot::receive(std::string_view bytes) {
  for (const char byte : bytes) {
    if (byte != '\n') {
      line_ += byte;
      continue;
    }
    const std::string field = std::exchange(line_, {});
    take_field(field);
  }
}

void Robot::take_field(const std::string& field) {
  if (field == "!stop" || field == "!release") {
    give_up();
    field_ = 0;
    return tell_(field == "!stop" ? "!stopped\n" : "!released\n");
  }
  if (field_ == 0) type_ = field;
  if (field_ == 1) subtype_ = field;
  if (field_ == 2) source_ = field;
  if (tell_) tell_("ok\n");
  if (++field_ < kFields) return;
  field_ = 0;
  if (type_ == "command") begin();
  if (type_ == "request") inform(subtype_, subtype_ == kBattery && battery_ ? charge_text() : "unknown", source_);
}

void Robot::begin() {
  if (work_) ++overlaps;
  skill_ = subtype_;
  if (broken_) return inform("failed", skill_ + " broken");
  if (on_begin) on_begin();
  work_ = std::make_shared<char>();
  const SkillTime& time = time_of_work();
  events_.after(dice_.normal(seconds(time.mean_s), seconds(time.deviation_s)), work_, [this] { end(true); });
}

const SkillTime& Robot::time_of_work() const {
  const auto of_task = plan_.times.find("task:" + (task ? task() : std::string()));
  const auto own = of_task == plan_.times.end() ? plan_.times.find(skill_) : of_task;
  return own == plan_.times.end() ? plan_.usual : own->second;
}

/// What it is at, if it is at anything.
void Robot::give_up() {
  if (!work_) return;
  work_.reset();
  if (on_give_up) on_give_up();
}

void Robot::end(bool well) {
  if (!well) give_up();
  work_.reset();
  if (well && on_end) on_end();
  if (!well) return inform("failed", skill_ + " broken");
  const std::string& result = time_of_work().result;
  inform("done", result.empty() ? skill_ : skill_ + " " + result);
}

void Robot::fail() {
  broken_ = true;
  owes_end_of_fault_ = false;
  if (on_fail) on_fail();
  inform_of_fault();
  if (work_) end(false);
}

void Robot::repair() {
  if (!broken_) return;
  broken_ = false;
  if (on_repair) on_repair();
  inform_of_repair();
}

void Robot::set_battery(const Battery& battery) {
  const bool drains_already = battery_.has_value();
  battery_ = battery;
  inform_of_charge();
  if (!drains_already) drain();
}

void Robot::drain() {
  constexpr Duration kLook = std::chrono::milliseconds(100);
  constexpr double kPart = 0.1;  // of a second
  events_.after(kLook, life_, [this] {
    const double before = battery_->percent;
    if (work_) battery_->percent = std::max(0.0, before - kPart * battery_->per_second);
    if (std::floor(battery_->percent) != std::floor(before)) inform_of_charge();
    if (battery_->percent <= 0 && !broken_) fail();
    drain();
  });
}

void Robot::inform_of_charge() {
  inform(std::string(kBattery), charge_text());
}

std::string Robot::charge_text() const {
  return std::to_string(static_cast<int>(battery_->percent));
}

void Robot::inform_of_fault() {
  for (const std::string& one : plan_.capabilities) inform("fault", one + " CRITICAL broken");
}

void Robot::inform_of_repair() {
  owes_end_of_fault_ = !tell_;
  for (const std::string& one : plan_.capabilities) inform("fault", one + " OVER");
}

void Robot::inform(const std::string& subtype, const std::string& data, const std::string& target) {
  if (tell_) tell_("information\n" + subtype + "\n" + target + "\n" + std::to_string(data.size()) + "\n" + data + "\n");
}

}  // namespace trb::world
