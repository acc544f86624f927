// "tls" in commands.json: the robot's interface is reached by TLS, and whose certificate is taken.
#pragma once

#include <optional>
#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"
#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"
#include "common/tls/tls_trust.hpp"

namespace trb {

/// What to do about a reason that begins with kTlsFailed.
inline constexpr const char* kTlsCure =
    "trb robot certificate NODE_DIR shows the robot's certificate, what is wrong with it, and what to write under "
    "\"tls\" in commands.json; then trb reload NODE_DIR";

/// Of a transport that can do so: {"fingerprint": ...} or {"authority": FILE, "name": ...}.
void read_tls_key(ObjectReader& vendor, VendorCommands& into);

/// Nothing: it is reached without TLS. Errors: io_error, malformed (the authority's file; each names the path).
Result<std::optional<TlsTrust>> read_robot_trust(const NodeConfig& config);

/// What read_robot_trust finds wrong, as a fault of the node's folder.
void check_robot_trust(const NodeConfig& config, ConfigFaults& faults);

}  // namespace trb
