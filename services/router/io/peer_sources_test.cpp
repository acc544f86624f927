// Who comes back while strangers are kept out.
#include "services/router/io/peer_sources.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::router;

namespace {

/// A peer that was linked, where it says that it can be dialled and where it was reached.
void meet(PeerTable& table, const std::string& id, const std::string& address, const std::string& reached = {}) {
  Certificate certificate;
  certificate.id = id;
  certificate.link_key.bytes = id;
  Peer& peer = table.learn(certificate, {});
  peer.met = true;
  peer.address = address;
  peer.good_address = reached;
}

}  // namespace

TEST_CASE("a source is named once: a network of many nodes leaves room for the others") {
  PeerTable table{RouterConfig{}};
  meet(table, "ant", "10.0.0.1:45000", "10.0.0.1:45000");
  meet(table, "bee", "10.0.0.2:45000", "192.168.1.2:45000");
  for (int i = 0; i < 300; ++i) meet(table, "cat" + std::to_string(i), "[2001:db8::" + std::to_string(i) + "]:45000");
  meet(table, "dog", "[2001:db8:0:1::7]:45000");
  meet(table, "elk", "");
  const std::vector<std::string> all = sources_of_peers(table);
  CHECK(all == std::vector<std::string>{"10.0.0.1", "10.0.0.2", "192.168.1.2", "2001:db8:0:1::/64", "2001:db8::/64"});
}
