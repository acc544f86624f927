// How a driver reports that a command is over.
#pragma once

#include <string>

#include "common/drivers/driver.hpp"

namespace trb::drivers {

/// A command that the robot has carried out or refused, and who waits for it.
struct CommandEnd {
  Token token = 0;
  std::string subtype;
  bool tracked = false;       ///< a skill waits for its end
  bool told_started = false;  ///< Started was reported
  bool forgotten = false;     ///< nobody waits for it any more
};

/// `text`: the result, or the reason of the failure.
void report_end(const CommandEnd& command, bool well, const std::string& text, const DriverOut& out);

}  // namespace trb::drivers
