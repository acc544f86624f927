#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "services/virtual-robots/ur/arm.hpp"
#include "services/virtual-robots/ur/events.hpp"
#include "services/virtual-robots/ur/machine.hpp"
#include "services/virtual-robots/ur/program_clock.hpp"
#include "services/virtual-robots/ur/registers.hpp"

namespace trb::virtual_robots::ur {

/** The controller of one arm: takes scripts and commands, runs one program at a time. `now` is robot time in seconds.
 */
class Controller {
 public:
  explicit Controller(RobotMode mode = RobotMode::running) : mode_(mode) {}

  /** A whole program or one line, as split by the intake. */
  void take(std::string_view script, double now);

  /** Events outside of the scripts; Normal clears a stop of either kind. An emergency stop takes the arm's power. */
  void set_safety(SafetyMode mode, double now);

  /** What the dashboard and the lines of a script's port ask for. False: refused, nothing has changed. */
  bool power_on(double now);
  void power_off(double now);
  /** Switches the power on first, if it is off. */
  bool release_brakes(double now);
  /** A protective stop must have lasted for kUnlockAfter seconds. */
  bool unlock(double now);
  /** False: no program runs. */
  bool stop(double now);
  bool pause(double now);
  bool resume(double now);

  /** The speed slider, 0 to 1. */
  void set_speed_fraction(double fraction, double now);

  /** Numbered as the bits of Io. */
  void set_output(int index, bool on);
  void set_input(int index, bool on);
  /** 0 to 1 of the range; what is beyond is cut off. */
  void set_analog_output(std::size_t index, double value);

  /** The registers that a client writes, and those that a program writes. */
  void set_input_registers(const Registers& registers) { inputs_ = registers; }
  const Registers& input_registers() const { return inputs_; }
  const Registers& output_registers() const { return outputs_; }

  static constexpr double kUnlockAfter = 5;

  /** An error message of the controller; the arm goes on. */
  void raise_error(ErrorLevel level, std::string text, double now);

  /** Carries out everything that is due. */
  void advance(double now);

  /** When advance has something to do; nothing while no program runs. */
  std::optional<double> next_deadline() const;

  RobotState state(double now) const;
  /** Of the running program, else `<unnamed>`. */
  std::string program_name() const { return program_ ? program_->name() : "<unnamed>"; }
  /** How many programs have been started so far. */
  std::uint64_t programs_started() const { return programs_started_; }
  std::vector<Event> take_events();

 private:
  bool take_command(std::string_view line, double now);
  void run_move(const MoveStep& step);
  void start(Program program, double now);
  void run_secondary(Program program, double now);
  void run_next();
  void stop_protectively();
  RobotState state_at(double program_time) const;
  World world(double program_time) const;
  void write_register(const RegisterStep& step);
  bool refuse_when_not_running();
  void run_step(const Step& step);
  /** In the program's time. */
  void end_program(double program_time);
  void stop_program(double now);
  bool in_operation() const { return mode_ == RobotMode::running && safety_ == SafetyMode::normal; }
  void stop_everything(double now);
  void emit(Event event) { events_.push_back(std::move(event)); }

  RobotMode mode_;
  SafetyMode safety_ = SafetyMode::normal;
  Arm arm_;
  std::optional<Machine> program_;
  double step_end_ = 0;
  bool moves_ = false;     ///< the step under way is a motion to a target: the slider scales it
  double stopped_at_ = 0;  ///< when the protective stop began
  ProgramClock clock_;
  Io io_;
  Registers inputs_;
  Registers outputs_;
  double speed_fraction_ = 1;
  std::uint64_t programs_started_ = 0;
  std::vector<Event> events_;
};

}  // namespace trb::virtual_robots::ur
