// The control port of a virtual robot (its --control).
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::adapter {

/// Sends one line as one datagram to HOST:PORT, a numeric host; there is no answer. Errors: io_error.
Status send_control_line(const std::string& where, const std::string& line);

}  // namespace trb::adapter
