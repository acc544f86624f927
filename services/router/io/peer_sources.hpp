// The sources of nodes that were linked before.
#pragma once

#include <string>
#include <vector>

#include "services/router/core/peer_table.hpp"

namespace trb::router {

/// Named as source_of() names them: a crowd of strangers must not keep them from coming back.
std::vector<std::string> sources_of_peers(const PeerTable& table);

}  // namespace trb::router
