// Links by themselves: sequence, keep-alives, leases, and when a peer is dialled again.
#include "services/router/core/links.hpp"

#include "services/router/core/admission.hpp"

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

TEST_CASE("who sends parts of a message without end is cut and listed, and neither dialled nor let in for a while") {
  Parts parts;
  Admission admission(parts.node, parts.table, parts.trust);
  parts.link_with(parts.bee);
  parts.table.find("bee")->address = "10.0.0.2:45000";
  const Bytes key = parts.bee.link.public_key;
  parts.links.on_incomplete(7, parts.now, parts.out);
  CHECK(parts.counted("cut.incomplete") == 1);
  CHECK(parts.all<CloseLink>().size() == 1);
  CHECK(parts.errors.table("ant", parts.now.mono).errors.at(0).code == "incomplete");
  const Duration denied = parts.node.config().timing.denied;
  const auto is_dialled = [&] {
    parts.links.tick(true, parts.now, parts.out);
    return !parts.all<Dial>().empty();
  };
  parts.pass(denied - std::chrono::milliseconds(1));
  parts.links.redial_all(parts.now);
  CHECK_FALSE(is_dialled());
  CHECK_FALSE(admission.admit(key, parts.now, parts.out));
  CHECK(parts.counted("refused.noisy_key") == 1);
  parts.pass(std::chrono::milliseconds(1));
  CHECK(admission.admit(key, parts.now, parts.out));
  parts.table.find("bee")->comes_until = {};
  CHECK(is_dialled());
}

TEST_CASE("of a link that is gone already, nothing happens for parts without end") {
  Parts parts;
  parts.links.on_incomplete(7, parts.now, parts.out);
  CHECK(parts.out.list.empty());
  CHECK(parts.out.counts.empty());
}
