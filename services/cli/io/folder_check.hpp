// Whether a node's folder can be worked in: whose its files are, who else may write them, its disk, and whether what
// the authority has signed can be read.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"

namespace trb::cli {

/// What `trb check` says of it. None of this keeps a node from starting.
ConfigFaults check_folder(const std::string& node_dir);

/// Whether this user may start the node: root would leave files in another user's folder which that one's services
/// cannot read. Errors: not_permitted; io_error if the disk can be read only, unless the bus needs no sockets there.
Status may_start(const std::string& node_dir, bool bus_in_folder);

}  // namespace trb::cli
