// A relay's side by itself: which peers it reports to which links, and what it passes on.
#include "services/router/core/reachable_peers.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Relay : Parts {
  LocalNode relay{relay_config()};
  OwnMessages own{relay};
  ReachablePeers reachable{relay, table, own};
  TestKeys cat = authority.sign_node("cat");
  Link& to_bee = link_with(bee, 7);
  Link& to_cat = link_with(cat, 8);

  RouterConfig relay_config() const {
    RouterConfig made = config();
    made.relay = true;
    made.own.relay = true;
    return made;
  }
  void pass_on(const std::string& signer, const std::string& target) {
    RelayedFrame inner;
    inner.target = target;
    inner.count = 5;
    Relayed body;
    body.record.signer = signer;
    reachable.pass_on(to_bee, make_message(MessageType::information, "bee", "ant", body), body, inner, now, out);
  }
};

}  // namespace

TEST_CASE("given a peer that is linked, then the others are told of it a tenth of a second later, together") {
  Relay relay;
  relay.reachable.on_change("bee", relay.now);
  relay.reachable.on_change("cat", relay.now);
  relay.reachable.tick(relay.now, relay.out);
  CHECK(relay.out.list.empty());
  relay.pass(std::chrono::milliseconds(100));
  relay.reachable.tick(relay.now, relay.out);
  const auto sent = relay.all<LinkSend>();
  REQUIRE(sent.size() == 2);
  CHECK(sent[0].link == 7);
  CHECK(decode<ReachablePeerList>(sent[0].message.data)->reached == std::vector<SignedRecord>{relay.cat.record});
  CHECK_FALSE(relay.reachable.next_deadline());
}

TEST_CASE("given one member that floods another by the relay, then the target's link keeps room for others' messages") {
  Relay relay;
  for (std::uint32_t i = 0; i < kCarriedOfOne + 5; ++i) relay.pass_on("bee", "cat");
  const auto sent = relay.all<LinkSend>();
  const auto to_cat = [](const LinkSend& one) { return one.link == 8; };
  CHECK(std::count_if(sent.begin(), sent.end(), to_cat) == kCarriedOfOne);
  CHECK(relay.counted("dropped.relayed_too_many") == 5);
  REQUIRE(sent.back().link == 7);
  CHECK(decode<RelayRefused>(sent.back().message.data)->reason == "queue_full");
  relay.pass(std::chrono::seconds(1));
  relay.pass_on("bee", "cat");
  CHECK(relay.all<LinkSend>().back().link == 8);
}

TEST_CASE("given a message of a link's own peer, then it goes on in this node's name; another's goes nowhere") {
  Relay relay;
  relay.pass_on("bee", "cat");
  REQUIRE(relay.all<LinkSend>().size() == 1);
  CHECK(relay.all<LinkSend>()[0].link == 8);
  CHECK(relay.all<LinkSend>()[0].message.source == "ant");
  relay.pass_on("cat", "cat");
  CHECK(relay.counted("refused.relayed_second_hop") == 1);
  CHECK(relay.all<LinkSend>().size() == 1);
}

TEST_CASE("given a target that is not reached, then who sent it is told which one") {
  Relay relay;
  relay.pass_on("bee", "dog");
  REQUIRE(relay.all<LinkSend>().size() == 1);
  const auto refused = decode<RelayRefused>(relay.all<LinkSend>()[0].message.data);
  CHECK(refused->target == "dog");
  CHECK(refused->count == 5);
  CHECK(refused->reason == "unknown_target");
}
