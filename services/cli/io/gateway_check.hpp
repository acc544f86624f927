// Asks trb-cloud-gateway, which stands beside trb, about the page's certificate: trb itself has no OpenSSL.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"

namespace trb::cli {

/// Of keys/gateway.crt and keys/gateway.key in that folder. Empty too if there is no such program here.
ConfigFaults check_gateway_certificate(const std::string& node_dir);

}  // namespace trb::cli
