#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "services/virtual-robots/ur/arm.hpp"
#include "services/virtual-robots/ur/events.hpp"

namespace trb::virtual_robots::ur {

/** The controller of one arm: takes scripts and commands, runs one program at a time. `now` is robot time in seconds.
 */
class Controller {
 public:
  explicit Controller(RobotMode mode = RobotMode::Running) : mode_(mode) {}

  /** A whole program or one line, as split by the intake. */
  void take(std::string_view script, double now);

  /** Events outside of the scripts; Normal clears a stop of either kind. */
  void set_safety(SafetyMode mode, double now);

  /** An error message of the controller; the arm goes on. */
  void raise_error(ErrorLevel level, std::string text, double now);

  /** Carries out everything that is due. */
  void advance(double now);

  /** When advance has something to do; nothing while no program runs. */
  std::optional<double> next_deadline() const;

  RobotState state(double now) const;
  /** Of the running program, else `<unnamed>`. */
  std::string program_name() const { return program_ ? program_->name : "<unnamed>"; }
  std::vector<Event> take_events();

 private:
  bool take_command(std::string_view line, double now);
  void start(Program program, double now);
  void run_secondary(const Program& program);
  bool refuse_when_not_running();
  void run_step(const Step& step);
  void stop_program(double now);
  void stop_everything(double now);
  void emit(Event event) { events_.push_back(std::move(event)); }

  RobotMode mode_;
  SafetyMode safety_ = SafetyMode::Normal;
  Arm arm_;
  std::optional<Program> program_;
  std::size_t next_step_ = 0;
  double step_end_ = 0;
  std::vector<Event> events_;
};

}  // namespace trb::virtual_robots::ur
