// Links by themselves: sequence, keep-alives, leases, and when a peer is dialled again.
#include "services/router/core/links.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Line : Parts {
  Link& link = link_with(bee);
  void tick() { links.tick(true, now, out); }
};

}  // namespace

TEST_CASE("given a frame out of sequence, then the link is over, and its peer is dialled again") {
  Line line;
  const Message note = make_message(MessageType::information, "bee", "ant", RobotFault{});
  CHECK(line.links.receive(line.link, header_of(note, 1), line.now, line.out));
  CHECK_FALSE(line.links.receive(line.link, header_of(note, 3), line.now, line.out));
  CHECK(line.table.link(7) == nullptr);
  CHECK(line.watcher.lost == std::vector<std::string>{"bee"});
  CHECK(line.table.find("bee")->redial.at);
  CHECK(line.counted("refused.sequence") == 1);
}

TEST_CASE("given a quiet link, then keep-alives leave four times in a lease, and without an echo it ends with it") {
  Line line;
  for (int i = 0; i < 3; ++i) {
    line.pass(std::chrono::milliseconds(2500));
    line.tick();
  }
  CHECK(line.all<LinkSend>().size() == 3);
  CHECK(line.link.unconfirmed.size() == 3);
  line.pass(std::chrono::milliseconds(2500));
  line.tick();
  CHECK(line.table.link(7) == nullptr);
}

TEST_CASE("given a peer without a link, when its lease is over, then it has expired once") {
  Line line;
  line.links.drop(7, "cable", false, line.now, line.out);
  line.pass(line.node.config().timing.lease - Duration(1));
  line.tick();
  CHECK_FALSE(line.table.find("bee")->expired);
  line.pass(Duration(1));
  line.tick();
  line.tick();
  CHECK(line.table.find("bee")->expired);
  CHECK(line.counted("peer_expired") == 1);
}

TEST_CASE(
    "given a seed, then it is dialled with the id that the random numbers give; nothing is while it is no member") {
  Parts parts;
  parts.table.seeds().push_back({"10.0.0.2:45000", parts.bee.link.public_key, {}, {}});
  parts.links.start(parts.now);
  parts.links.tick(false, parts.now, parts.out);
  CHECK(parts.all<Dial>().empty());
  parts.pass(std::chrono::seconds(2));
  parts.links.tick(true, parts.now, parts.out);
  REQUIRE(parts.all<Dial>().size() == 1);
  CHECK(parts.all<Dial>()[0].link == 4711);
}
