// The control port of a virtual robot (its --control).
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::adapter {

/// Sends one line as one datagram to HOST:PORT, the host as four numbers; nothing answers it. Errors: io_error.
Status send_control_line(const std::string& where, const std::string& line);

}  // namespace trb::adapter
