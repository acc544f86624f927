#include "services/virtual-robots/ur/controller.hpp"

#include <algorithm>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

/** The code of "the robot is not in operation", which is sent with the refusal of a program. */
constexpr int kNotRunningCode = 100;
/** The code of an injected fault; not one of the maker's. */
constexpr int kInjectedCode = 999;

}  // namespace

void Controller::take(std::string_view script, double now) {
  advance(now);
  if (take_command(trim(script), now)) return;
  auto compiled = compile(script);
  if (const auto* error = std::get_if<ScriptError>(&compiled)) {
    emit(ScriptRefused{*error});
    return;
  }
  if (refuse_when_not_running()) return;
  auto& program = std::get<Program>(compiled);
  if (program.secondary) {
    run_secondary(program);
  } else {
    start(std::move(program), now);
  }
}

bool Controller::take_command(std::string_view line, double now) {
  if (line == "stop program") {
    stop_everything(now);
  } else if (line == "power off") {
    stop_program(now);
    mode_ = RobotMode::PowerOff;
  } else if (line == "power on") {
    if (mode_ == RobotMode::PowerOff) mode_ = RobotMode::Idle;
  } else if (line == "set robotmode run") {
    if (mode_ == RobotMode::Idle) mode_ = RobotMode::Running;
  } else if (line == "set unlock protective stop") {
    if (safety_ == SafetyMode::ProtectiveStop) set_safety(SafetyMode::Normal, now);
  } else {
    return false;
  }
  return true;
}

bool Controller::refuse_when_not_running() {
  if (mode_ == RobotMode::Running && safety_ == SafetyMode::Normal) return false;
  const int reason = safety_ == SafetyMode::Normal ? static_cast<int>(mode_) : 100 + static_cast<int>(safety_);
  emit(ErrorRaised{kNotRunningCode, reason, ErrorLevel::Violation, "robot_not_running"});
  emit(ScriptRefused{{1, 1, "runtime_error_robot_not_running:"}});
  return true;
}

void Controller::set_safety(SafetyMode mode, double now) {
  advance(now);
  if (mode == safety_) return;
  safety_ = mode;
  emit(SafetyChanged{mode});
  if (mode != SafetyMode::Normal) stop_everything(now);
}

void Controller::raise_error(ErrorLevel level, std::string text, double now) {
  advance(now);
  emit(ErrorRaised{kInjectedCode, 0, level, std::move(text)});
}

void Controller::start(Program program, double now) {
  // A real controller stops the running program before it takes the next one, and reports that.
  stop_program(now);
  emit(ProgramStarted{program.name});
  program_ = std::move(program);
  next_step_ = 0;
  step_end_ = now;
  advance(now);
}

void Controller::run_secondary(const Program& program) {
  // The compiler allows no step that takes time in a secondary program, so the running one is not disturbed.
  emit(SecondaryRun{program.name});
  for (const Step& step : program.steps) run_step(step);
}

void Controller::advance(double now) {
  while (program_ && step_end_ <= now) {
    if (next_step_ == program_->steps.size()) {
      stop_program(step_end_);
    } else {
      run_step(program_->steps[next_step_++]);
    }
  }
  arm_.settle(now);
}

/** Begins a step where the last one ended, so that delays do not add up over a program. */
void Controller::run_step(const Step& step) {
  if (const auto* move = std::get_if<MoveStep>(&step)) {
    emit(MoveStarted{*move});
    step_end_ = arm_.start(*move, step_end_);
  } else if (const auto* speed = std::get_if<SpeedStep>(&step)) {
    emit(SpeedStarted{*speed});
    step_end_ = arm_.run(*speed, step_end_);
  } else if (const auto* sleep = std::get_if<SleepStep>(&step)) {
    step_end_ += std::max(0.0, sleep->seconds);
  } else if (const auto* out = std::get_if<DigitalOutStep>(&step)) {
    emit(DigitalOutSet{*out});
  } else if (const auto* text = std::get_if<TextStep>(&step)) {
    emit(TextSaid{text->text});
  } else if (const auto* halt = std::get_if<HaltStep>(&step)) {
    step_end_ = arm_.brake(halt->acceleration, step_end_);
    emit(Stopped{});
  }
}

void Controller::stop_program(double now) {
  if (!program_) return;
  arm_.halt(now);
  emit(ProgramStopped{program_->name});
  program_.reset();
}

void Controller::stop_everything(double now) {
  stop_program(now);
  emit(Stopped{});
}

std::optional<double> Controller::next_deadline() const {
  if (!program_) return std::nullopt;
  return step_end_;
}

RobotState Controller::state(double now) const {
  return {mode_, safety_, program_.has_value(), arm_.at(now)};
}

std::vector<Event> Controller::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::ur
