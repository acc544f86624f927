#include "services/virtual-robots/ur/events.hpp"

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

std::string numbers_of(const std::array<double, 6>& numbers) {
  std::string out;
  for (const double number : numbers) out += " " + format_fixed(number, 4);
  return out;
}

struct ToPacket {
  using Result = std::optional<std::string>;
  std::uint64_t time_us;

  Result operator()(const ProgramStarted& event) const {
    return key_packet("PROGRAM_XXX_STARTED", event.name, time_us);
  }
  Result operator()(const ProgramStopped& event) const {
    return key_packet("PROGRAM_XXX_STOPPED", event.name, time_us);
  }
  Result operator()(const TextSaid& event) const { return text_packet(event.text, time_us); }
  Result operator()(const ScriptRefused& event) const { return exception_packet(event.error, time_us); }
  Result operator()(const ErrorRaised& event) const {
    return error_packet(event.code, event.argument, event.level, event.text, time_us);
  }
  Result operator()(const SafetyChanged& event) const { return safety_packet(event.mode, time_us); }
  Result operator()(const SecondaryRun&) const { return std::nullopt; }
  Result operator()(const MoveStarted&) const { return std::nullopt; }
  Result operator()(const SpeedStarted&) const { return std::nullopt; }
  Result operator()(const DigitalOutSet&) const { return std::nullopt; }
  Result operator()(const Stopped&) const { return std::nullopt; }
};

std::string safety_name(SafetyMode mode) {
  if (mode == SafetyMode::normal) return "normal";
  return mode == SafetyMode::protective_stop ? "protective_stop" : "estop";
}

struct ToLine {
  std::string operator()(const ProgramStarted& event) const { return "program " + event.name + " started"; }
  std::string operator()(const ProgramStopped& event) const { return "program " + event.name + " stopped"; }
  std::string operator()(const SecondaryRun& event) const { return "secondary " + event.name; }
  std::string operator()(const MoveStarted& event) const {
    const std::string start = "move " + event.step.function;
    if (const auto* joints = std::get_if<Joints>(&event.step.target)) return start + numbers_of(*joints);
    return start + " p" + numbers_of(std::get<Pose>(event.step.target).values);
  }
  std::string operator()(const SpeedStarted& event) const {
    return "speed " + event.step.function + numbers_of(event.step.speeds);
  }
  std::string operator()(const DigitalOutSet& event) const {
    return "digital_out " + std::to_string(event.step.index) + (event.step.on ? " on" : " off");
  }
  std::string operator()(const TextSaid& event) const { return "text " + escape_line(event.text); }
  std::string operator()(const ScriptRefused& event) const {
    const ScriptError& error = event.error;
    return "script_error " + std::to_string(error.line) + " " + std::to_string(error.column) + " " +
           escape_line(error.text);
  }
  std::string operator()(const ErrorRaised& event) const {
    return "error C" + std::to_string(event.code) + "A" + std::to_string(event.argument) + " " +
           escape_line(event.text);
  }
  std::string operator()(const SafetyChanged& event) const { return "safety " + safety_name(event.mode); }
  std::string operator()(const Stopped&) const { return "stopped"; }
};

}  // namespace

std::optional<std::string> packet_of(const Event& event, std::uint64_t time_us) {
  return std::visit(ToPacket{time_us}, event);
}

std::string line_of(const Event& event) {
  return std::visit(ToLine{}, event);
}

}  // namespace trb::virtual_robots::ur
