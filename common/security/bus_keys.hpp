// The keys of a bus over TCP: keys/bus/NAME.key (0600) and NAME.pub for each service, for "router" and for "probe"
// (trb). The key identifies the service; so a service's container has its own NAME.key and router.pub, the router's
// container all NAME.pub.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/security/keys.hpp"

namespace trb {

constexpr std::string_view kBusRouter = "router";
constexpr std::string_view kBusProbe = "probe";  ///< for trb

/// Makes these names' keys where they are missing. A NAME.pub without its NAME.key is left alone: its secret is with
/// its service, elsewhere. Errors: io_error, and those of load_bus_key.
Status make_bus_keys(const std::string& node_dir, const std::vector<std::string>& names);

/// Errors: missing, not_permitted (mode is not 0600), malformed; each with the hint.
Result<LinkKey> load_bus_key(const std::string& node_dir, std::string_view name);
/// 32 bytes. Errors: missing, malformed.
Result<Bytes> load_bus_public(const std::string& node_dir, std::string_view name);

/// Faults of the existing files, for `trb check`: mode, content, a NAME.pub that does not match its NAME.key.
void check_bus_keys(const std::string& node_dir, const std::vector<std::string>& names, ConfigFaults& faults);

}  // namespace trb
