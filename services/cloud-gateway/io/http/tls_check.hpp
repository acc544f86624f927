// What would keep the gateway from serving with the files that are there: for `trb check`, which starts nothing.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/time.hpp"

namespace trb::gateway {

/// Of NODE_DIR/keys/gateway.crt and gateway.key; nothing is written. No fault: both are missing, for the first start
/// makes them; or what provide_tls_files() mends at a start.
ConfigFaults check_tls_files(const std::string& node_dir, UtcTime now);

}  // namespace trb::gateway
