#include "services/virtual-robots/pioneer/controller.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::pioneer {
namespace {

// Before SYNC2 is answered 0, 1 and 2 are the SYNCs; afterwards they are PULSE, OPEN and CLOSE.
enum Number : int {
  kPulse = 0,
  kOpen = 1,
  kClose = 2,
  kEnable = 4,
  kSetA = 5,
  kSetV = 6,
  kSetO = 7,
  kMove = 8,
  kRotate = 9,
  kSetRv = 10,
  kVel = 11,
  kHead = 12,
  kDhead = 13,
  kConfig = 18,
  kRvel = 21,
  kDchead = 22,
  kSetRa = 23,
  kSonar = 28,
  kStop = 29,
  kDigOut = 30,
  kEStop = 55,
};

constexpr int kSyncs = 3;
constexpr int kCounter = 0x7fff;  // x and y are counted in 15 bits
constexpr int kOutOfSequence = 255;
constexpr int kSonarDiscs = 16;
constexpr int kSonarPerSip = 4;
constexpr int kNothingNear = 5000;  // mm
constexpr int kWheelsStalled = 0x0101;
constexpr int kFrontBumper = 0x0002;
constexpr double kEmptyVoltage = 11.0;
constexpr double kFullVoltage = 12.8;
constexpr double kHalfWheelbase = 165;        // mm
constexpr double kStandingLife = 6 * 3600.0;  // seconds of a full battery
constexpr double kMovingLife = 3 * 3600.0;

Position composed(const Position& origin, const Position& inside) {
  const double x = inside.x / 1000;
  const double y = inside.y / 1000;
  return {origin.x + x * std::cos(origin.heading) - y * std::sin(origin.heading),
          origin.y + x * std::sin(origin.heading) + y * std::cos(origin.heading),
          std::remainder(origin.heading + inside.heading, 2 * std::numbers::pi)};
}

int whole(double number) {
  return static_cast<int>(std::lround(number));
}

void limit(Drive::Limits& limits, int value) {
  (value < 0 ? limits.deceleration : limits.acceleration) = std::max(1, std::abs(value));
}

}  // namespace

Controller::Controller(const Start& start) : start_(start), turned_(start.place), charge_(start.charge) {}

std::string Controller::take(std::string_view bytes, double wall) {
  std::string answers;
  for (const Command& command : reader_.add(bytes)) {
    heard_ = wall;
    if (std::exchange(watchdog_, false)) {
      drive_.hold(false);
      tell("watchdog resumed");
    }
    answers += synced_ < kSyncs ? on_sync(command) : on_command(command);
  }
  if (const int wrong = reader_.take_wrong(); wrong > 0) tell("wrong_checksum " + std::to_string(wrong));
  return answers;
}

std::string Controller::on_sync(const Command& command) {
  if (command.number == 0) synced_ = 0;
  if (command.number != synced_) {
    synced_ = 0;
    return PacketWriter(kOutOfSequence).packet();
  }
  PacketWriter echo(synced_++);
  if (synced_ < kSyncs) return echo.packet();
  tell("synced");
  return echo.text(start_.name).text("Pioneer").text("p3dx-sh").packet();
}

std::string Controller::on_command(const Command& command) {
  if (command.number == kPulse) return {};
  tell("command " + std::to_string(command.number) + (command.value ? " " + std::to_string(*command.value) : "") +
       (command.text ? " " + escape_line(*command.text) : ""));
  if (on_motion(command)) return {};
  const int value = command.value.value_or(0);
  switch (command.number) {
    case kOpen:
      open_ = true;
      break;
    case kClose:
      close();
      break;
    case kEnable:
      motors_ = value != 0 && fault_ != Fault::stop_button;
      if (!motors_) drive_.block();
      break;
    case kSetO:
      turned_ = composed(turned_, drive_.position());
      drive_.set_origin();
      break;
    case kSonar:
      sonar_ = value != 0;
      break;
    case kDigOut:
      digital_out_ = (digital_out_ & ~(value >> 8)) | (value & value >> 8);
      break;
    case kConfig:
      return config();
    default:
      on_limit(command);
  }
  return {};
}

void Controller::on_limit(const Command& command) {
  const int value = command.value.value_or(0);
  if (flash_.take(command.number, value)) return;
  if (command.number == kSetA) limit(drive_.drive_limits, value);
  if (command.number == kSetRa) limit(drive_.turn_limits, value);
  if (command.number == kSetV && value > 0) drive_.drive_limits.speed = value;
  if (command.number == kSetRv && value > 0) drive_.turn_limits.speed = value;
}

bool Controller::on_motion(const Command& command) {
  const int value = command.value.value_or(0);
  const bool can_move = motors_ && fault_ == Fault::none;
  switch (command.number) {
    case kMove:
      if (can_move) drive_.move(value);
      return true;
    case kVel:
      if (can_move) drive_.set_speed(value);
      return true;
    case kRotate:
    case kRvel:
      if (can_move) drive_.set_turn(value);
      return true;
    case kHead:
      if (can_move) drive_.turn_to(value);
      return true;
    case kDhead:
    case kDchead:
      if (can_move) drive_.turn_by(value);
      return true;
    case kStop:
    case kEStop:
      drive_.stop(command.number == kEStop);
      return true;
    default:
      return false;
  }
}

void Controller::close() {
  open_ = false;
  motors_ = false;
  synced_ = 0;
  drive_.block();
}

void Controller::advance(double robot_seconds, double wall) {
  if (open_ && !watchdog_ && wall - heard_ >= kWatchdog) {
    watchdog_ = true;
    drive_.hold(true);
    tell("watchdog halted");
  }
  drive_.advance(robot_seconds);
  const bool moving = !drive_.is_still();
  charge_ = std::max(0.0, charge_ - robot_seconds * 100 / (moving ? kMovingLife : kStandingLife));
  if (moving_ && !moving) tell_place();
  moving_ = moving;
}

Position Controller::place() const {
  return composed(turned_, drive_.position());
}

void Controller::tell_place() {
  const Position at = place();
  tell("at " + format_fixed(at.x, 3) + " " + format_fixed(at.y, 3) + " " + format_fixed(at.heading, 3));
}

void Controller::set_fault(Fault fault, const std::string& text) {
  constexpr const char* kNames[] = {"none", "stall", "motors_off", "stop_button"};
  fault_ = fault;
  tell("fault " + std::string(kNames[static_cast<int>(fault)]) + (text.empty() ? "" : " " + escape_line(text)));
  if (fault == Fault::none) return;
  if (fault != Fault::stall) motors_ = false;
  drive_.block();
}

double Controller::voltage() const {
  return kEmptyVoltage + (kFullVoltage - kEmptyVoltage) * charge_ / 100;
}

int Controller::stall_bits() const {
  if (fault_ == Fault::none) return 0;
  return fault_ == Fault::stop_button ? kWheelsStalled : kWheelsStalled | kFrontBumper;
}

int Controller::flag_bits() const {
  int flags = motors_ ? 1 : 0;
  if (sonar_) flags |= 1 << 1 | 1 << 2;
  if (fault_ == Fault::stop_button) flags |= 1 << 5 | 1 << 6;
  return flags;
}

std::string Controller::sip() {
  if (!open_) return {};
  const Position& at = drive_.position();
  const double turning = drive_.turn() * kHalfWheelbase;
  const int tenths = whole(voltage() * 10);
  PacketWriter out(moving_ ? 0x33 : 0x32);
  out.word(whole(at.x) & kCounter).word(whole(at.y) & kCounter).word(whole(at.heading * 2048 / std::numbers::pi));
  out.word(whole(drive_.speed() - turning)).word(whole(drive_.speed() + turning));
  out.byte(tenths).word(stall_bits()).word(0).word(flag_bits()).byte(0);
  out.byte(sonar_ ? kSonarPerSip : 0);
  for (int i = 0; sonar_ && i < kSonarPerSip; ++i) {
    out.byte(disc_).word(kNothingNear);
    disc_ = (disc_ + 1) % kSonarDiscs;
  }
  out.byte(0).byte(0).byte(0).byte(0).byte(digital_out_);
  out.word(tenths).byte(0).word(whole(drive_.turn() * 1800 / std::numbers::pi)).word(0);
  return out.packet();
}

std::string Controller::config() const {
  const Drive::Limits& drive = drive_.drive_limits;
  const Drive::Limits& turn = drive_.turn_limits;
  PacketWriter out(0x20);
  out.text("Pioneer").text("p3dx-sh").text("VIRTUAL").byte(0);
  out.word(300).word(1500).word(300).word(2000).word(400);           // the highest turn, speed, accelerations and PWM
  out.text(start_.name).byte(100).byte(0).byte(0);                   // packets every 100 ms; baud rates
  out.word(0).word(1).byte(1);                                       // gripper; front and rear sonar
  out.word(115).word(flash_.encoder_revolution).word(2000).byte(0);  // low battery, watchdog
  out.word(flash_.stall_pwm).word(flash_.stall_ms).word(0).word(0);  // joystick
  out.word(whole(turn.speed)).word(whole(drive.speed));
  out.word(whole(turn.acceleration)).word(whole(turn.deceleration));
  out.word(flash_.turn.proportional).word(flash_.turn.derivative).word(flash_.turn.integral);
  out.word(whole(drive.acceleration)).word(whole(drive.deceleration));
  out.word(flash_.drive.proportional).word(flash_.drive.derivative).word(flash_.drive.integral);
  out.byte(5).byte(5).byte(0).byte(40).byte(0).byte(0).word(0);  // bumpers, charger, sonar cycle, baud, gyro, drift
  out.byte(0).byte(0).word(flash_.encoder_ticks_mm).word(110).text("2.6");  // baud rates, shutdown voltage, version
  return out.word(0).word(0).byte(0).packet();
}

std::vector<std::string> Controller::take_lines() {
  return std::exchange(lines_, {});
}

}  // namespace trb::virtual_robots::pioneer
