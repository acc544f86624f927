#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trb::virtual_robots::plc {

enum class BeltState : std::uint16_t { Ready = 0, Running = 1, BoxAtExit = 2, Fault = 3 };

/** The values of the controller's fault register; 0 is none. */
enum class FaultCode : std::uint16_t { None = 0, MotorOverload = 1, EmergencyStop = 2, BeltSlips = 3, MotorHot = 4 };

std::string_view name_of(FaultCode code);

struct ConveyorSettings {
  double length_mm = 2000;
  /** A belt that starts without a box gets one at its entry; a box that waits at the exit is taken away. */
  bool brings_boxes = false;
};

/**
 * A belt, its motor, the box on it, and its controller's program: the belt stops when the box is at the exit, and for a
 * fault or an emergency stop, after which it has to be reset. `now` is robot time in seconds.
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

  ConveyorSettings settings_;
  bool running_ = false;
  bool box_ = false;
  std::uint16_t speed_ = 500;
  FaultCode fault_ = FaultCode::None;
  double start_mm_ = 0;  ///< where the box was at since_
  double since_ = 0;
  std::uint32_t boxes_ = 0;
  std::vector<std::string> events_;
};

}  // namespace trb::virtual_robots::plc
