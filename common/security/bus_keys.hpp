// The keys of a bus over TCP: keys/bus/NAME.key (0600) and NAME.pub, of each service, of "router" and of "probe" (trb).
// Who shows which key is whom; so a container holds its own service's NAME.key and router.pub, the router's all
// NAME.pub.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/security/keys.hpp"

namespace trb {

constexpr std::string_view kBusRouter = "router";
constexpr std::string_view kBusProbe = "probe";  ///< for trb

/// Makes what is missing of these names' keys. A NAME.pub without its NAME.key is left alone: the secret lies with its
/// service, elsewhere. Errors: io_error, and those of load_bus_key.
Status make_bus_keys(const std::string& node_dir, const std::vector<std::string>& names);

/// Errors: missing, not_permitted (mode is not 0600), malformed; each with the hint.
Result<LinkKey> load_bus_key(const std::string& node_dir, std::string_view name);
/// 32 bytes. Errors: missing, malformed.
Result<Bytes> load_bus_public(const std::string& node_dir, std::string_view name);

/// Faults of the files that are there, for `trb check`: mode, content, a NAME.pub that is not its NAME.key's.
void check_bus_keys(const std::string& node_dir, const std::vector<std::string>& names, ConfigFaults& faults);

}  // namespace trb
