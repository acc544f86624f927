#include "services/virtual-robots/ur/controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

/** Sent with the refusal of a program while the robot is not in operation; not one of the maker's. */
constexpr int kNotRunningCode = 100;
/** The code of an injected fault; not one of the maker's. */
constexpr int kInjectedCode = 999;
/** The maker's "position in singularity": a straight line cannot be followed any further. */
constexpr int kNoWayCode = 154;

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
    run_secondary(std::move(program), now);
  } else {
    start(std::move(program), now);
  }
}

bool Controller::take_command(std::string_view line, double now) {
  if (line == "stop program") {
    stop_everything(now);
  } else if (line == "power off") {
    power_off(now);
  } else if (line == "power on") {
    power_on(now);
  } else if (line == "set robotmode run") {
    release_brakes(now);
  } else if (line == "set unlock protective stop") {
    unlock(now);
  } else {
    return false;
  }
  return true;
}

bool Controller::power_on(double now) {
  advance(now);
  if (safety_ == SafetyMode::emergency_stop) return false;
  if (mode_ == RobotMode::power_off) mode_ = RobotMode::idle;
  return true;
}

void Controller::power_off(double now) {
  advance(now);
  stop_program(now);
  mode_ = RobotMode::power_off;
}

bool Controller::release_brakes(double now) {
  if (!power_on(now)) return false;
  mode_ = RobotMode::running;
  return true;
}

bool Controller::unlock(double now) {
  if (safety_ != SafetyMode::protective_stop || now - stopped_at_ < kUnlockAfter) return false;
  set_safety(SafetyMode::normal, now);
  return true;
}

bool Controller::stop(double now) {
  advance(now);
  if (!program_) return false;
  stop_everything(now);
  return true;
}

bool Controller::pause(double now) {
  advance(now);
  if (!program_ || clock_.paused()) return false;
  clock_.pause(now);
  return true;
}

bool Controller::resume(double now) {
  if (!program_ || !clock_.paused() || !in_operation()) return false;
  clock_.resume(now);
  return true;
}

bool Controller::refuse_when_not_running() {
  if (in_operation()) return false;
  const int reason = safety_ == SafetyMode::normal ? static_cast<int>(mode_) : 100 + static_cast<int>(safety_);
  emit(ErrorRaised{kNotRunningCode, reason, ErrorLevel::violation, "robot_not_running"});
  emit(ScriptRefused{{1, 1, "runtime_error_robot_not_running:"}});
  return true;
}

void Controller::set_safety(SafetyMode mode, double now) {
  advance(now);
  if (mode == safety_) return;
  safety_ = mode;
  emit(SafetyChanged{mode});
  if (mode == SafetyMode::protective_stop) stopped_at_ = now;
  if (mode != SafetyMode::normal) stop_everything(now);
  if (mode == SafetyMode::emergency_stop) mode_ = RobotMode::power_off;
}

void Controller::set_speed_fraction(double fraction, double now) {
  advance(now);
  speed_fraction_ = std::clamp(fraction, 0.0, 1.0);
  arm_.scale(speed_fraction_, clock_.at(now));
  if (program_ && moves_) step_end_ = arm_.end();
}

void Controller::raise_error(ErrorLevel level, std::string text, double now) {
  advance(now);
  emit(ErrorRaised{kInjectedCode, 0, level, std::move(text)});
}

void Controller::start(Program program, double now) {
  // A real controller stops the running program before it takes the next one, and reports that.
  stop_program(now);
  ++programs_started_;
  emit(ProgramStarted{program.name});
  program_.emplace(std::move(program));
  step_end_ = clock_.at(now);
  moves_ = false;
  advance(now);
}

void Controller::run_secondary(Program program, double now) {
  // The compiler allows no step that takes time in a secondary program, so the running one is not disturbed.
  emit(SecondaryRun{program.name});
  Machine machine(std::move(program));
  for (;;) {
    auto next = machine.next(world(clock_.at(now)), 0);
    if (const auto* error = std::get_if<ScriptError>(&next)) emit(ScriptRefused{*error});
    const auto* step = std::get_if<Step>(&next);
    if (step == nullptr) return;
    run_step(*step);
  }
}

void Controller::advance(double now) {
  const double due = clock_.at(now);
  while (program_ && step_end_ <= due) run_next();
  arm_.settle(due);
}

void Controller::run_next() {
  moves_ = false;
  auto next = program_->next(world(step_end_), step_end_);
  if (const auto* step = std::get_if<Step>(&next)) return run_step(*step);
  if (const auto* error = std::get_if<ScriptError>(&next)) emit(ScriptRefused{*error});
  end_program(step_end_);
}

World Controller::world(double program_time) const {
  World world{state_at(program_time), inputs_, outputs_};
  world.state.program_running = true;
  return world;
}

/** Begins a step where the last one ended, so that delays do not add up over a program. */
void Controller::run_step(const Step& step) {
  if (const auto* move = std::get_if<MoveStep>(&step)) {
    run_move(*move);
  } else if (const auto* speed = std::get_if<SpeedStep>(&step)) {
    emit(SpeedStarted{*speed});
    step_end_ = arm_.run(*speed, step_end_);
  } else if (const auto* sleep = std::get_if<SleepStep>(&step)) {
    step_end_ += std::max(0.0, sleep->seconds);
  } else if (const auto* out = std::get_if<DigitalOutStep>(&step)) {
    set_output(out->index, out->on);
    emit(DigitalOutSet{*out});
  } else if (const auto* text = std::get_if<TextStep>(&step)) {
    emit(TextSaid{text->text});
  } else if (const auto* halt = std::get_if<HaltStep>(&step)) {
    step_end_ = arm_.brake(halt->acceleration, step_end_);
    emit(Stopped{});
  } else if (const auto* tool = std::get_if<ToolStep>(&step)) {
    arm_.set_tool(tool->tool);
  } else if (const auto* written = std::get_if<RegisterStep>(&step)) {
    write_register(*written);
  } else if (std::holds_alternative<ProtectiveStopStep>(step)) {
    stop_protectively();
  }
}

/** A program stops itself. */
void Controller::stop_protectively() {
  safety_ = SafetyMode::protective_stop;
  stopped_at_ = clock_.when(step_end_);
  emit(SafetyChanged{safety_});
  end_program(step_end_);
  emit(Stopped{});
}

void Controller::write_register(const RegisterStep& step) {
  const auto index = static_cast<std::size_t>(step.index);
  if (step.kind == RegisterStep::Kind::integer) outputs_.integers[index] = static_cast<std::int32_t>(step.value);
  if (step.kind == RegisterStep::Kind::float_) outputs_.doubles[index] = step.value;
  if (step.kind == RegisterStep::Kind::boolean) outputs_.set_bit(step.index, step.value != 0);
}

void Controller::run_move(const MoveStep& step) {
  emit(MoveStarted{step});
  if (arm_.start(step, step_end_)) {
    moves_ = true;
    step_end_ = arm_.end();
    return;
  }
  if (step.function == "movel") {
    emit(ErrorRaised{kNoWayCode, 0, ErrorLevel::violation, "Position in singularity"});
  } else {
    emit(ScriptRefused{{step.line, step.column,
                        "The robot cannot reach the requested pose. Script function " + step.function +
                            " is unable to find an inverse kinematics solution."}});
  }
  end_program(step_end_);
}

void Controller::set_output(int index, bool on) {
  const std::uint64_t bit = std::uint64_t{1} << (index & 63);
  io_.outputs = on ? io_.outputs | bit : io_.outputs & ~bit;
}

void Controller::set_input(int index, bool on) {
  const std::uint64_t bit = std::uint64_t{1} << (index & 63);
  io_.inputs = on ? io_.inputs | bit : io_.inputs & ~bit;
}

void Controller::set_analog_output(std::size_t index, double value) {
  if (index < io_.analog_outputs.size()) io_.analog_outputs[index] = std::clamp(value, 0.0, 1.0);
}

void Controller::end_program(double program_time) {
  if (!program_) return;
  arm_.halt(program_time);
  emit(ProgramStopped{program_->name()});
  program_.reset();
  moves_ = false;
}

void Controller::stop_program(double now) {
  clock_.resume(now);
  end_program(clock_.at(now));
}

void Controller::stop_everything(double now) {
  stop_program(now);
  emit(Stopped{});
}

std::optional<double> Controller::next_deadline() const {
  if (!program_ || clock_.paused() || !std::isfinite(step_end_)) return std::nullopt;
  return clock_.when(step_end_);
}

RobotState Controller::state(double now) const {
  RobotState state = state_at(clock_.at(now));
  if (clock_.paused()) state.joints.speed = {};
  return state;
}

RobotState Controller::state_at(double program_time) const {
  const bool paused = clock_.paused();
  return {mode_, safety_,    program_.has_value() && !paused, paused, speed_fraction_, arm_.at(program_time),
          io_,   arm_.tool()};
}

std::vector<Event> Controller::take_events() {
  return std::exchange(events_, {});
}

}  // namespace trb::virtual_robots::ur
