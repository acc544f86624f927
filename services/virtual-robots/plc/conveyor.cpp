#include "services/virtual-robots/plc/conveyor.hpp"

#include <algorithm>

namespace trb::virtual_robots::plc {
namespace {

constexpr double kEntryMm = 100;  ///< how far the light barrier at the entry sees

}  // namespace

std::string_view name_of(FaultCode code) {
  switch (code) {
    case FaultCode::none:
      return "none";
    case FaultCode::motor_overload:
      return "motor_overload";
    case FaultCode::emergency_stop:
      return "emergency_stop";
    case FaultCode::belt_slips:
      return "belt_slips";
    case FaultCode::motor_hot:
      return "motor_hot";
  }
  return "unknown";
}

bool Conveyor::stops_belt(FaultCode code) {
  return code == FaultCode::motor_overload || code == FaultCode::emergency_stop;
}

void Conveyor::settle(double now) {
  start_mm_ = position_mm(now);
  since_ = now;
}

void Conveyor::run(bool on, double now) {
  if (!on) return halt("command", now);
  if (running_ || !may_run()) return;
  end_jog("run", now);
  if (settings_.brings_boxes && box_at_exit()) take_box(now);
  if (settings_.brings_boxes && !box_) place_box(now);
  settle(now);
  running_ = true;
  events_.push_back("belt on " + std::to_string(speed_));
  advance(now);
}

void Conveyor::jog(std::int16_t mm_per_s, double now) {
  advance(now);
  if (mm_per_s == 0 || !may_jog()) return end_jog("command", now);
  settle(now);
  if (mm_per_s > 0 && box_at_exit()) return end_jog("exit", now);
  if (jog_ != mm_per_s) events_.push_back("jog " + std::to_string(mm_per_s));
  jog_ = mm_per_s;
  jog_until_ = now + settings_.jog_holds_s;
  advance(now);
}

void Conveyor::end_jog(const std::string& why, double now) {
  if (jog_ == 0) return;
  settle(now);
  jog_ = 0;
  events_.push_back("jog off " + why);
}

void Conveyor::halt(const std::string& why, double now) {
  end_jog(why, now);
  if (!running_) return;
  settle(now);
  running_ = false;
  events_.push_back("belt off " + why);
}

void Conveyor::set_speed(std::uint16_t mm_per_s, double now) {
  settle(now);
  speed_ = mm_per_s;
}

void Conveyor::place_box(double now) {
  if (box_) return;
  box_ = true;
  start_mm_ = 0;
  since_ = now;
  events_.emplace_back("box entry");
}

void Conveyor::take_box(double now) {
  if (!box_) return;
  settle(now);
  box_ = false;
  start_mm_ = 0;
  events_.emplace_back("box taken");
}

void Conveyor::fault(FaultCode code, double now) {
  advance(now);
  // The worse fault stays: a warm motor does not hide an emergency stop.
  if (stops_belt(fault_) && !stops_belt(code)) return;
  fault_ = code;
  events_.push_back("fault " + std::string(name_of(code)));
  if (stops_belt(code)) halt(std::string(name_of(code)), now);
}

void Conveyor::reset(double now) {
  if (fault_ == FaultCode::motor_overload) clear(now);
}

void Conveyor::clear(double now) {
  advance(now);
  if (std::exchange(fault_, FaultCode::none) != FaultCode::none) events_.emplace_back("clear");
}

bool Conveyor::reaches_exit(double now) const {
  return speed() > 0 && box_ && position_mm(now) >= settings_.length_mm;
}

void Conveyor::advance(double now) {
  const bool held_long_enough = jog_ != 0 && now >= jog_until_;
  if (reaches_exit(held_long_enough ? jog_until_ : now)) {
    ++boxes_;
    events_.emplace_back("box exit");
    halt("exit", now);
  }
  if (held_long_enough) end_jog("hold", jog_until_);
}

std::optional<double> Conveyor::next_deadline() const {
  std::optional<double> next;
  if (jog_ != 0) next = jog_until_;
  if (speed() <= 0 || !box_) return next;
  const double exit = since_ + (settings_.length_mm - start_mm_) / speed();
  return next ? std::min(*next, exit) : exit;
}

double Conveyor::position_mm(double now) const {
  if (!box_) return 0;
  const double position = std::max(start_mm_ + speed() * std::max(now - since_, 0.0), 0.0);
  // A microsecond before the end counts as the end: a rounded deadline must not be due again.
  return position >= settings_.length_mm - 1e-3 ? settings_.length_mm : position;
}

bool Conveyor::box_at_entry(double now) const {
  return box_ && position_mm(now) < kEntryMm;
}

BeltState Conveyor::state() const {
  if (stops_belt(fault_)) return BeltState::fault;
  if (moving()) return BeltState::running;
  return box_at_exit() ? BeltState::box_at_exit : BeltState::ready;
}

double Conveyor::temperature() const {
  if (fault_ == FaultCode::motor_hot || fault_ == FaultCode::motor_overload) return 95.5;
  return moving() ? 41.5 : 24.5;
}

double Conveyor::current_a() const {
  if (!moving()) return 0;
  return fault_ == FaultCode::belt_slips ? 0.4 : 1.2;
}

}  // namespace trb::virtual_robots::plc
