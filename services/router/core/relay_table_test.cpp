// The rows of the ways by relays by themselves: which is due, which is open, which goes.
#include "services/router/core/relay_table.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

using Ids = std::vector<std::string>;

SensorInfo sensor(const std::string& name, const std::string& kind) {
  SensorInfo out;
  out.name = name;
  out.kind = kind;
  return out;
}

struct Rows : Parts {
  LocalProfile profile{node, table, messages, errors};
  RelayTable rows{node, table, profile};

  /// A member that this node knows, and has no link with.
  Peer& member(const TestKeys& keys) { return table.learn(keys.certificate, keys.record); }
  [[nodiscard]] Ids untold() const { return {rows.untold().begin(), rows.untold().end()}; }
};

}  // namespace

TEST_CASE("given rows that are touched, then the earliest is due first, and nobody before its time") {
  Rows all;
  const TestKeys dog = all.authority.sign_node("dog");
  CHECK_FALSE(all.rows.earliest());
  all.rows.row(all.member(all.bee)).connection.begin(all.now.mono + std::chrono::seconds(2));
  all.rows.row(all.member(dog)).connection.begin(all.now.mono + std::chrono::seconds(1));
  CHECK(all.rows.earliest() == all.now.mono + std::chrono::seconds(1));
  CHECK(all.rows.due(all.now.mono).empty());
  CHECK(all.rows.due(all.now.mono + std::chrono::seconds(1)) == Ids{"dog"});
  CHECK(all.rows.due(all.now.mono + std::chrono::seconds(2)) == Ids{"dog", "bee"});
}

TEST_CASE("given an open way without a link, then its peer is untold until it has the newest profile") {
  Rows all;
  Peer& bee = all.member(all.bee);
  all.rows.row(bee).open = true;
  CHECK(all.rows.open().contains("bee"));
  all.profile.on_sensors({{sensor("eye", "camera")}}, all.out);
  CHECK(all.untold() == Ids{"bee"});
  all.rows.row(bee).told_profile = all.profile.number();
  CHECK(all.untold().empty());
  all.profile.on_sensors({{sensor("ear", "sound")}}, all.out);
  CHECK(all.untold() == Ids{"bee"});
  bee.link = 7;
  (void)all.rows.row(bee);
  CHECK(all.untold().empty());
}

TEST_CASE("given another computer of the same name, then its way begins anew") {
  Rows all;
  Peer& bee = all.member(all.bee);
  RelayRoute& route = all.rows.row(bee);
  route.open = true;
  route.key = "of the computer before";
  ++bee.number;
  CHECK_FALSE(all.rows.find(bee).open);
  CHECK_FALSE(all.rows.row(bee).open);
  CHECK(all.rows.row(bee).key.empty());
}

TEST_CASE("given a peer that is forgotten, then its row goes, and is not due any more") {
  Rows all;
  RelayRoute& route = all.rows.row(all.member(all.bee));
  route.open = true;
  route.connection.begin(all.now.mono);
  REQUIRE(all.rows.earliest());
  all.rows.drop_without_peer();
  CHECK(all.rows.rows().size() == 1);
  all.table.forget("bee");
  all.rows.drop_without_peer();
  CHECK(all.rows.rows().empty());
  CHECK(all.rows.open().empty());
  CHECK_FALSE(all.rows.earliest());
}
