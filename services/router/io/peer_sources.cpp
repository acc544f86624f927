#include "services/router/io/peer_sources.hpp"

#include <set>

#include "common/config/interfaces.hpp"
#include "common/transport/source_filter.hpp"

namespace trb::router {

std::vector<std::string> sources_of_peers(const PeerTable& table) {
  std::set<std::string> out;  // each takes a place in the filter
  for (const auto& [id, peer] : table.peers()) {
    if (!peer.met) continue;
    for (const std::string& address : {peer.address, peer.good_address}) {
      const std::string host = split_endpoint(address).host;
      if (!host.empty()) out.insert(source_of(without_scope(host)));
    }
  }
  return {out.begin(), out.end()};
}

}  // namespace trb::router
