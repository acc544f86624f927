// The node's credentials for its robot: keys/robot.auth, one line, mode 0600.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"

namespace trb {

/// What the file holds. A MiR takes the hash in the password's place, and refuses the password itself.
inline constexpr const char* kSignInLine =
    "one line: basic USER:PASSWORD, digest USER:PASSWORD, or bearer TOKEN; for a MiR the SHA-256 of the password in "
    "its place: echo -n "
    "PASSWORD | sha256sum";
/// What a robot's answer 401 is called, so that a person is given kSignInCure wherever it is shown.
inline constexpr const char* kSignInRefused = "refuses the sign-in";
inline constexpr const char* kSignInCure =
    "write keys/robot.auth in the node's folder, mode 0600, with a user of the robot that has the right: basic "
    "USER:PASSWORD, digest USER:PASSWORD (if the robot asks for Digest), or bearer TOKEN; for a MiR the SHA-256 of the "
    "password in its place: echo -n PASSWORD | sha256sum; then trb reload NODE_DIR";
/// The same of 403: it knows who asks.
inline constexpr const char* kNotAllowed = "does not allow it";
inline constexpr const char* kNotAllowedCure =
    "give the user in keys/robot.auth the right on the robot, or look at the robot's mode and at who has the control "
    "there";

/// "basic USER:PASSWORD" or "bearer TOKEN" as the value of HTTP's Authorization header (RFC 7617, RFC 6750); "digest
/// USER:PASSWORD" as "Digest USER:PASSWORD", from which each request's value is made (RFC 7616); empty without the
/// file. Errors: not_permitted (others may read it), malformed, io_error; each names the path.
Result<std::string> read_robot_auth(const std::string& node_dir);

/// What read_robot_auth finds wrong, as a fault of the node's folder.
void check_robot_auth(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
