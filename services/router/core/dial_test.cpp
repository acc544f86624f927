// Which peers are dialled, and two nodes that dial each other.
#include <doctest/doctest.h>

#include "services/router/test/name_dial.hpp"
#include "services/router/test/test_inbox.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// Dials the bee, whose answer does not come.
struct Dialler {
  TestFleet fleet;
  TestNode& node;
  TestKeys bee = fleet.keys("bee");
  explicit Dialler(const std::string& id) : node(fleet.start(id, {.beacon = false, .seeds = {"bee"}})) {
    fleet.start("bee", {.beacon = false});
    fleet.cut(id, "bee");
    fleet.run(kStep);
    REQUIRE(node.dials.size() == 1);
  }
  [[nodiscard]] LinkId dial() const { return node.dials[0].link; }
  void greet(LinkId link, const std::string& address = "10.0.0.2:45000") {
    const Hello hello{bee.record, 3, address, "1", kStartUtc, true, {}, 0, "behind", false, ""};
    Effects effects;
    node.core->inbox().on_message(link, bee.link.public_key,
                                  make_message(MessageType::information, "bee", node.id, hello), 1, fleet.now, effects);
    fleet.carry_out(node, effects);
  }
  /// A second message by this link.
  void speak(LinkId link) {
    Effects effects;
    const Message word = make_message(MessageType::information, "bee", node.id, KeepAlive{});
    node.core->forwarding().from_link(link, header_of(word, 2, link), encode_frame(word), fleet.now, effects);
    fleet.carry_out(node, effects);
  }
};

}  // namespace

TEST_CASE("a Hello that comes while its node is being dialled carries nothing until a second word comes by its link") {
  Dialler one("ant");
  one.greet(9);
  REQUIRE(one.node.core->table().link(9) != nullptr);
  CHECK(one.node.core->table().link(9)->up);
  CHECK(one.node.link_to("bee") == 0);
  one.speak(9);
  CHECK(one.node.link_to("bee") == 9);
}

TEST_CASE("a dial that is answered after the better link is there is ended, and the better link stays") {
  Dialler one("cat");
  one.greet(9);
  one.speak(9);
  REQUIRE(one.node.link_to("bee") == 9);  // the smaller id's
  one.greet(one.dial());
  CHECK(one.node.link_to("bee") == 9);
  CHECK(one.node.core->table().link(one.dial()) == nullptr);
  CHECK(one.node.log.back() == "link_closed bee: a better link to bee is up");
}

TEST_CASE("who is at the door is not dialled: its own dial has its time to say Hello") {
  Inbox inbox;
  TestNode& ant = inbox.ant;
  inbox.say_hello(9, inbox.bee);
  Effects effects;
  ant.core->links().on_ended(9, LinkEndReason::disconnected, inbox.fleet.now, effects);
  inbox.fleet.carry_out(ant, effects);
  CHECK(inbox.admit(inbox.bee.link.public_key));
  inbox.fleet.run(milliseconds(1900));
  CHECK(ant.dials.empty());
  inbox.fleet.run(milliseconds(500));  // it did not come
  CHECK_FALSE(ant.dials.empty());
}

TEST_CASE("the name of a host that was dialled is nobody's good address") {
  TestFleet fleet;
  const RouterConfig& config = fleet.start("ant", {.beacon = false}).core->config();
  const TestKeys bee = fleet.keys("bee");
  NameDial of(fleet, config, bee.link.public_key);
  RouterCore& core = of.core;
  const LinkId link = of.link;
  const Hello hello{bee.record, 3, "", "1", kStartUtc, true, {}, 0, "behind", false, ""};
  core.inbox().on_message(link, bee.link.public_key, make_message(MessageType::information, "bee", "ant", hello), 1,
                          fleet.now, of.effects);
  REQUIRE(core.table().peers().at("bee").link == link);
  CHECK(core.table().peers().at("bee").good_address.empty());
}
