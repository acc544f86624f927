// The node's credentials for its robot: keys/robot.auth, one line, mode 0600.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"

namespace trb {

/// "basic USER:PASSWORD" or "bearer TOKEN" as the value of HTTP's Authorization header (RFC 7617, RFC 6750); empty
/// without the file. Errors: not_permitted (others may read it), malformed, io_error; each names the path.
Result<std::string> read_robot_auth(const std::string& node_dir);

/// What read_robot_auth finds wrong, as a fault of the node's folder.
void check_robot_auth(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
