// The lane table by itself: which peers may listen, and when the other side's lane is dialled.
#include "services/router/core/lane_table.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Lanes : Parts {
  LaneTable lanes{node, table};
  Link& link = link_with(bee);
  const Bytes& key = bee.link.public_key;

  void open() {
    lanes.open(link, {bee.record, 3, "", "1", kStartUtc, true, {}, 0, "behind", false, "10.0.0.2:45001"}, now);
  }
  std::size_t dials() {
    out = {};
    lanes.tick(now, out);
    return all<DialLane>().size();
  }
};

}  // namespace

TEST_CASE("given a link that is up, then its lane is dialled half a second later, once") {
  Lanes lanes;
  lanes.open();
  CHECK(lanes.dials() == 0);
  lanes.pass(kLaneAfter);
  CHECK(*lanes.lanes.next_deadline() == lanes.now.mono);
  CHECK(lanes.dials() == 1);
  CHECK(lanes.dials() == 0);
  CHECK_FALSE(lanes.lanes.next_deadline());
}

TEST_CASE("given a lane that ends again and again, then it is dialled ever less often") {
  Lanes lanes;
  lanes.open();
  for (const Duration wait : {kLaneFirst, 2 * kLaneFirst, 4 * kLaneFirst}) {
    lanes.lanes.on_ended(lanes.link.id, LinkEndReason::failed, lanes.now, lanes.out);
    CHECK(*lanes.lanes.of(lanes.link.id).dial_at == lanes.now.mono + wait);
  }
}

TEST_CASE("given a link that has ended before its lane was dialled, then nothing is dialled") {
  Lanes lanes;
  lanes.open();
  lanes.table.remove(lanes.link.id);
  lanes.pass(kLaneAfter);
  CHECK_FALSE(lanes.lanes.next_deadline());
  CHECK(lanes.dials() == 0);
}

TEST_CASE("only the peer of a link may listen, to its own topic, until it misuses the lane") {
  Lanes lanes;
  CHECK_FALSE(lanes.lanes.admit(make_link_key().public_key, lanes.out));
  CHECK(lanes.lanes.admit(lanes.key, lanes.out));
  CHECK_FALSE(lanes.lanes.on_listen(lanes.key, topic_of("be"), lanes.out));
  CHECK(lanes.lanes.on_listen(lanes.key, topic_of("bee"), lanes.out) == lanes.link.id);
  CHECK(lanes.lanes.listens(lanes.link.id));
  lanes.lanes.bar(lanes.key, lanes.out);
  CHECK_FALSE(lanes.lanes.listens(lanes.link.id));
  CHECK_FALSE(lanes.lanes.admit(lanes.key, lanes.out));
}

TEST_CASE("given a lane that sent parts of a message without end, then it is not dialled again beside its link") {
  Lanes lanes;
  lanes.open();
  lanes.pass(kLaneAfter);
  REQUIRE(lanes.dials() == 1);
  lanes.lanes.on_connected(lanes.link.id, lanes.now);
  lanes.lanes.on_incomplete(lanes.link.id, lanes.out);
  CHECK(lanes.counted("cut.incomplete") == 1);
  CHECK_FALSE(lanes.lanes.of(lanes.link.id).connected);
  CHECK_FALSE(lanes.lanes.next_deadline());
  lanes.pass(2 * kLaneMost);
  CHECK(lanes.dials() == 0);
}

TEST_CASE("given a listener that sent more than subscriptions, then it is barred until its link has ended") {
  Lanes lanes;
  CHECK(lanes.lanes.on_listen(lanes.key, topic_of("bee"), lanes.out) == lanes.link.id);
  lanes.lanes.bar(lanes.link.id, lanes.out);
  CHECK_FALSE(lanes.lanes.listens(lanes.link.id));
  CHECK_FALSE(lanes.lanes.admit(lanes.key, lanes.out));
}
