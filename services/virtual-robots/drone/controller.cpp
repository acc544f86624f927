#include "services/virtual-robots/drone/controller.hpp"

#include <array>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::drone {
namespace {

constexpr std::uint32_t kTakeOffBit = 1U << 9;
constexpr std::uint32_t kEmergencyBit = 1U << 8;
constexpr std::int32_t kAcknowledge = 5;
constexpr double kMostOptions = 0xffffffff;

std::string_view name_of(Phase phase) {
  switch (phase) {
    case Phase::cut:
      return "cut";
    case Phase::landed:
      return "landed";
    case Phase::flying:
      return "flying";
    case Phase::hovering:
      return "hovering";
    case Phase::taking_off:
      return "taking_off";
    case Phase::landing:
      break;
  }
  return "landing";
}

}  // namespace

void Controller::take(std::string_view datagram, double now) {
  advance(now);
  const Datagram read = parse_datagram(datagram);
  for (const std::string& line : read.rejected) events_.push_back("rejected " + escape_line(line));
  for (const Command& command : read.commands) take_command(command, now);
  tell_phase();
}

/** A number that does not increase belongs to a late datagram; 1 is a client that has restarted. */
bool Controller::is_new(const Command& command) {
  if (command.sequence <= last_sequence_ && command.sequence != 1) {
    events_.push_back("ignored " + command.name + " " + std::to_string(command.sequence) + " after " +
                      std::to_string(last_sequence_));
    return false;
  }
  last_sequence_ = command.sequence;
  return true;
}

void Controller::take_command(const Command& command, double now) {
  if (!is_new(command)) return;
  last_command_ = now;
  has_client_ = true;
  if (command.name == "COMWDG") {
    end_watchdog();
  } else if (command.name == "REF") {
    take_reference(command);
  } else if (command.name == "PCMD") {
    take_motion(command);
  } else if (command.name == "CONFIG") {
    take_config(command);
  } else if (command.name == "CTRL") {
    if (integer_argument(command, 0) == kAcknowledge) command_taken_ = false;
  } else {
    take_other(command);
  }
}

void Controller::take_reference(const Command& command) {
  const auto number = integer_argument(command, 0);
  if (!number) return reject(command);
  const auto reference = static_cast<std::uint32_t>(*number);
  const bool toggle = (reference & kEmergencyBit) != 0;
  if (toggle && !emergency_bit_) toggle_emergency();
  emergency_bit_ = toggle;
  if (holds_ || emergency_) return;
  if ((reference & kTakeOffBit) == 0) {
    refused_take_off_ = false;
    return aircraft_.land();
  }
  if (!aircraft_.take_off() && !std::exchange(refused_take_off_, true))
    events_.emplace_back("take_off_refused battery_low");
}

void Controller::take_motion(const Command& command) {
  const auto mode = integer_argument(command, 0);
  std::array<double, 4> axes{};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto axis = float_argument(command, i + 1);
    if (!mode || !axis || *axis < -1 || *axis > 1) return reject(command);
    axes[i] = *axis;
  }
  const bool progressive = (*mode & 1) != 0;
  if (!holds_) aircraft_.steer(progressive ? Stick{axes[0], axes[1], axes[2], axes[3]} : Stick{});
}

void Controller::take_config(const Command& command) {
  if (command.arguments.size() != 2) return reject(command);
  const std::string& key = command.arguments[0];
  const std::string& value = command.arguments[1];
  command_taken_ = true;
  if (key == "general:navdata_demo") wish_.kind = value == "TRUE" ? NavdataKind::demo : NavdataKind::all;
  const auto number = parse_number(value);
  if (key == "general:navdata_options" && number && *number >= 0 && *number <= kMostOptions) {
    wish_.options = static_cast<std::uint32_t>(*number);
  }
  if (key == "control:altitude_max" && number) aircraft_.set_ceiling(*number / 1000);
  events_.push_back("config " + escape_line(key) + " " + escape_line(value));
}

/** Trimming, lights and figures: accepted, but not imitated. */
void Controller::take_other(const Command& command) {
  std::string event =
      command.name == "FTRIM" || command.name == "LED" || command.name == "ANIM" || command.name == "CALIB"
          ? "command " + command.name
          : "unknown " + command.name;
  for (const std::string& argument : command.arguments) event += " " + escape_line(argument);
  events_.push_back(std::move(event));
}

void Controller::toggle_emergency() {
  emergency_ = !emergency_;
  events_.emplace_back(emergency_ ? "emergency on" : "emergency off");
  if (emergency_) return aircraft_.cut_motors();
  injected_ &= ~bits::kCutout;
  aircraft_.restore();
}

void Controller::fail_emergency() {
  injected_ |= bits::kCutout;
  if (!emergency_) toggle_emergency();
}

void Controller::clear_faults() {
  if (emergency_) toggle_emergency();
  injected_ = 0;
}

void Controller::wake(bool other_client) {
  tells_ = true;
  if (other_client) wish_ = {};
}

void Controller::end_watchdog() {
  if (std::exchange(watchdog_, false)) events_.emplace_back("watchdog off");
  holds_ = lost_ = false;
}

void Controller::advance(double now) {
  aircraft_.advance((now - last_advance_) * speed_);
  last_advance_ = now;
  watch(now);
  tell_phase();
}

/** Before its first client a drone is watched by nobody: it has the bit, but has lost nobody. */
void Controller::watch(double now) {
  const double silence = now - last_command_;
  if (silence >= kWatchdog_s && !std::exchange(watchdog_, true)) events_.emplace_back("watchdog on");
  if (!has_client_) return;
  if (silence >= kHolds_s && !std::exchange(holds_, true)) aircraft_.steer({});
  if (silence >= kLost_s && !std::exchange(lost_, true)) {
    last_sequence_ = 0;
    tells_ = false;
    events_.emplace_back("communication lost");
  }
  if (silence >= kLandsAfter_s) aircraft_.land();
}

void Controller::tell_phase() {
  const Phase phase = aircraft_.phase();
  if (std::exchange(told_phase_, phase) != phase) events_.push_back("state " + std::string(name_of(phase)));
}

std::uint32_t Controller::state() const {
  std::uint32_t state = bits::kAltitudeControl | bits::kCameraReady | bits::kPicVersionOk | bits::kThreads | injected_;
  if (aircraft_.in_air()) state |= bits::kFlying;
  if (command_taken_) state |= bits::kCommandTaken;
  if (wish_.kind == NavdataKind::demo) state |= bits::kDemo;
  if (wish_.kind == NavdataKind::bootstrap) state |= bits::kBootstrap;
  if (watchdog_) state |= bits::kComWatchdog;
  if (lost_) state |= bits::kComLost;
  if (aircraft_.battery_low()) state |= bits::kBatteryLow;
  if (emergency_) state |= bits::kEmergency;
  return state;
}

std::string Controller::navdata() {
  return navdata_packet(state(), ++navdata_sequence_, aircraft_, wish_, last_advance_ - begin_);
}

std::vector<std::string> Controller::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::drone
