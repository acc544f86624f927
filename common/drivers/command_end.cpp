#include "common/drivers/command_end.hpp"

namespace trb::drivers {

void report_end(const CommandEnd& command, bool well, const std::string& text, const DriverOut& out) {
  const std::string line = command.subtype + ": " + text.substr(0, 200);
  if (command.forgotten) return out.out.log(LogLevel::info, "late_report", line);
  if (!well && !command.told_started) {
    return out.emit(Refused{command.token, fail(Errc::robot_error, "the robot refuses it: " + text,
                                                "look at the command, its data and the robot's program")});
  }
  if (!command.told_started) out.emit(Started{command.token});
  if (command.tracked) out.emit(Ended{command.token, well, text});
  if (!well) out.out.log(LogLevel::warning, "command_failed", line);
}

}  // namespace trb::drivers
