// The peer table by itself: rows by name, by key and by link.
#include "services/router/core/peer_table.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("given a member that is learned again with other keys, then it is another computer under the same name") {
  Parts parts;
  Peer& peer = parts.table.learn(parts.bee.certificate, parts.bee.record);
  peer.beacon_boot = 9;
  const std::uint64_t number = peer.number;
  CHECK(parts.table.learn(parts.bee.certificate, parts.bee.record).number == number);
  const TestKeys other = parts.authority.sign_node("bee", Role::robot, 2);
  CHECK(parts.table.learn(other.certificate, other.record).number == number + 1);
  CHECK(peer.beacon_boot == 0);
  CHECK(parts.table.by_key(parts.bee.link.public_key) == nullptr);
  CHECK(parts.table.by_key(other.link.public_key) == &peer);
}

TEST_CASE("given a peer that is forgotten, then its key is nobody's, and its seed is not named any more") {
  Parts parts;
  parts.table.seeds().push_back({"10.0.0.2:45000", parts.bee.link.public_key, {}, {}});
  parts.table.learn(parts.bee.certificate, parts.bee.record);
  CHECK(parts.table.seeds()[0].peer == "bee");
  parts.table.forget("bee");
  CHECK(parts.table.find("bee") == nullptr);
  CHECK(parts.table.by_key(parts.bee.link.public_key) == nullptr);
  CHECK(parts.table.seeds()[0].peer.empty());
  CHECK(parts.table.is_expected(parts.bee.link.public_key));  // as a seed
}

TEST_CASE("only the links that carry are up, and a dialled one is not found as a peer's") {
  Parts parts;
  parts.link_with(parts.bee);
  Link dial;
  dial.id = 8;
  dial.dialled = true;
  dial.key = make_link_key().public_key;
  const Link& dialled = parts.table.add(std::move(dial));
  CHECK(parts.table.up_links() == std::vector<LinkId>{7});
  CHECK(parts.table.linked_by_key(parts.bee.link.public_key)->id == 7);
  CHECK(parts.table.linked_by_key(dialled.key) == nullptr);
  CHECK(parts.table.is_dialling(dialled.key));
  CHECK_FALSE(parts.table.is_dialling(parts.bee.link.public_key));
}
