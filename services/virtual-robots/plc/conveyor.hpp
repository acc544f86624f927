#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trb::virtual_robots::plc {

enum class BeltState : std::uint16_t { ready = 0, running = 1, box_at_exit = 2, fault = 3 };

/** The values of the controller's fault register; 0 is none. */
enum class FaultCode : std::uint16_t {
  none = 0,
  motor_overload = 1,
  emergency_stop = 2,
  belt_slips = 3,
  motor_hot = 4
};

std::string_view name_of(FaultCode code);

struct ConveyorSettings {
  double length_mm = 2000;
  /** A belt that starts without a box gets one at its entry; a box that waits at the exit is taken away. */
  bool brings_boxes = false;
  /** For so long, in robot time, a jog goes on after its last word. */
  double jog_holds_s = 0.4;
};

/**
 * A belt, its motor, the box on it, and its controller's program: the belt stops when the box is at the exit, and for a
 * fault or an emergency stop, after which it has to be reset. A jog is the motion by hand, either way: the belt stands
 * by itself once no word of it has come for a while. `now` is robot time in seconds.
 */
class Conveyor {
 public:
  static constexpr std::uint16_t kSlowest = 10;
  static constexpr std::uint16_t kFastest = 1000;

  explicit Conveyor(const ConveyorSettings& settings) : settings_(settings) {}

  // For the controller.
  bool may_run() const { return !stops_belt(fault_); }
  void run(bool on, double now);
  void set_speed(std::uint16_t mm_per_s, double now);
  /** Moves the belt by hand; 0 ends that. */
  void jog(std::int16_t mm_per_s, double now);
  /** The program's own run goes before. */
  bool may_jog() const { return may_run() && !running_; }
  /** Acknowledges a motor overload, but no fault that still lasts. */
  void reset(double now);

  // Events from outside.
  void place_box(double now);
  void take_box(double now);
  void fault(FaultCode code, double now);
  void clear(double now);

  /** Stops the belt when its time has come. */
  void advance(double now);
  std::optional<double> next_deadline() const;

  bool running() const { return running_; }
  bool moving() const { return running_ || jog_ != 0; }
  /** mm/s; below 0 towards the entry. */
  std::int16_t speed() const { return running_ ? static_cast<std::int16_t>(speed_) : jog_; }
  std::int16_t jog_setting() const { return jog_; }
  std::uint16_t speed_setting() const { return speed_; }
  double position_mm(double now) const;
  bool box_on_belt() const { return box_; }
  bool box_at_entry(double now) const;
  bool box_at_exit() const { return box_ && start_mm_ >= settings_.length_mm; }
  FaultCode fault_code() const { return fault_; }
  BeltState state() const;
  double temperature() const;
  double current_a() const;
  std::uint32_t boxes() const { return boxes_; }

  std::vector<std::string> take_events() { return std::exchange(events_, {}); }

 private:
  static bool stops_belt(FaultCode code);
  /** Continues from the box's present position. */
  void settle(double now);
  void halt(const std::string& why, double now);
  void end_jog(const std::string& why, double now);
  bool reaches_exit(double now) const;

  ConveyorSettings settings_;
  bool running_ = false;
  bool box_ = false;
  std::uint16_t speed_ = 500;
  std::int16_t jog_ = 0;
  double jog_until_ = 0;
  FaultCode fault_ = FaultCode::none;
  double start_mm_ = 0;  ///< where the box was at since_
  double since_ = 0;
  std::uint32_t boxes_ = 0;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::plc
