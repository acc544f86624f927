// What a peer must know, and finds its link full: it is told once there is room.
#include "services/router/core/tell_again.hpp"

#include <doctest/doctest.h>

#include <utility>

#include "services/router/test/test_pair.hpp"
#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// A node's link to another one takes nothing of this kind, as a full queue does, until it is free.
class FullLink {
 public:
  FullLink(TestFleet& fleet, TestNode& from, std::string to, std::string_view subtype)
      : fleet_(fleet), from_(from), to_(std::move(to)) {
    fleet_.withhold = [this, subtype](const std::string& node, const Message& message) {
      const bool stays = node == from_.id && message.target == to_ && message.subtype == subtype;
      if (stays) stuck_.push_back(message);
      return stays;
    };
  }
  FullLink(const FullLink&) = delete;
  FullLink& operator=(const FullLink&) = delete;
  ~FullLink() { fleet_.withhold = nullptr; }

  /// Time passes; whatever did not leave is reported, as the shell does.
  void run(Duration time) {
    for (Duration passed{}; passed < time; passed += kStep) {
      fleet_.run(kStep);
      for (const Message& message : std::exchange(stuck_, {})) {
        ++times_;
        Effects effects;
        from_.core->forwarding().on_own_unsent(message, Errc::queue_full, fleet_.now, effects);
        fleet_.carry_out(from_, effects);
      }
    }
  }
  /// How often something did not leave.
  [[nodiscard]] std::size_t times() const { return times_; }

 private:
  TestFleet& fleet_;
  TestNode& from_;
  std::string to_;
  std::vector<Message> stuck_;
  std::size_t times_ = 0;
};

/// The mode-adapter of the node, connection 2, reports its robot.
void report(TestFleet& fleet, TestNode& node, const NodeProfile& robot) {
  Effects effects;
  node.core->bus().on_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", fleet.now, effects);
  node.core->forwarding().on_bus_message(2, make_message(MessageType::information, node.id, node.id, robot), fleet.now,
                                         effects);
  fleet.carry_out(node, effects);
}

/// The authority's first list, which names cat.
TrustUpdate list_of(const TestFleet& fleet) {
  RevocationList list;
  list.fleet = {fleet.authority.fleet.id()};
  list.number = 1;
  list.revoked = {{1, "cat", "stolen", kStartUtc}};
  return {sign(kSignedRevocations, "", fleet.authority.fleet.id(), encode(list), fleet.authority.key), {}};
}

void take(TestFleet& fleet, TestNode& node, const TrustUpdate& update) {
  Effects effects;
  REQUIRE(node.core->updates().on_update(update, 0, fleet.now, effects));
  fleet.carry_out(node, effects);
}

}  // namespace

TEST_CASE("a robot's state that found the link full is told once there is room, as it is by then") {
  LinkedPair pair;
  NodeProfile robot;
  robot.robot = "ONLINE";
  report(pair.fleet, pair.ant, robot);
  pair.fleet.run(Seconds(1));
  REQUIRE(pair.bee.peer("ant")->profile.robot == "ONLINE");
  robot.fenced = true;
  {
    FullLink full(pair.fleet, pair.ant, "bee", NodeProfile::kSubtype);
    report(pair.fleet, pair.ant, robot);
    full.run(Seconds(5));
    CHECK(full.times() == 5);  // once a second
    CHECK_FALSE(pair.bee.peer("ant")->profile.fenced);
  }
  pair.fleet.run(Seconds(1) + kStep);
  CHECK(pair.bee.peer("ant")->profile.fenced);
  const std::uint64_t told = pair.ant.count("told_again");
  pair.fleet.run(Seconds(10));
  CHECK(pair.ant.count("told_again") == told);
}

TEST_CASE("who is revoked is told to a peer whose link was full when the list came") {
  LinkedPair pair;
  {
    FullLink full(pair.fleet, pair.ant, "bee", TrustUpdate::kSubtype);
    take(pair.fleet, pair.ant, list_of(pair.fleet));
    full.run(Seconds(3));
    CHECK(full.times() == 3);
    CHECK(pair.bee.count("news.lists") == 0);
  }
  pair.fleet.run(Seconds(1) + kStep);
  CHECK(pair.bee.count("news.lists") == 1);
}

TEST_CASE("a link that is gone is not told again what its successor is told anyhow") {
  LinkedPair pair;
  {
    FullLink full(pair.fleet, pair.ant, "bee", TrustUpdate::kSubtype);
    take(pair.fleet, pair.ant, list_of(pair.fleet));
    full.run(2 * kStep);
    REQUIRE(full.times() == 1);
  }
  Effects effects;
  pair.ant.core->links().drop(pair.ant.link_to("bee"), "test", true, pair.fleet.now, effects);
  pair.fleet.carry_out(pair.ant, effects);
  pair.fleet.cut("ant", "bee");
  pair.fleet.run(Seconds(5));
  CHECK(pair.ant.count("told_again") == 0);
  CHECK_FALSE(pair.ant.core->next_deadline() == std::nullopt);
}

TEST_CASE("a relay tells again whom it reaches, and whom it reaches no more") {
  Triangle three;
  const auto relays = [&] { return three.ant->relay_route("bee").relays.contains("cloud"); };
  REQUIRE(relays());
  {
    FullLink full(three.fleet, three.cloud, "ant", ReachablePeerList::kSubtype);
    three.fleet.stop("bee");
    full.run(Seconds(15));
    CHECK(full.times() > 1);
    CHECK(relays());
  }
  three.fleet.run(Seconds(1) + kStep);
  CHECK_FALSE(relays());
}

TEST_CASE("a robot's state that a relay could not pass on is told once more") {
  Triangle three;
  NodeProfile robot;
  robot.robot = "ONLINE";
  report(three.fleet, *three.ant, robot);
  three.fleet.run(Seconds(2));
  REQUIRE(three.bee->peer("ant")->profile.robot == "ONLINE");
  robot.fenced = true;
  {
    FullLink full(three.fleet, three.cloud, "bee", Relayed::kSubtype);
    report(three.fleet, *three.ant, robot);
    full.run(milliseconds(1500));
    CHECK_FALSE(three.bee->peer("ant")->profile.fenced);
  }
  three.fleet.run(Seconds(2));
  CHECK(three.bee->peer("ant")->profile.fenced);
}

TEST_CASE("what may be lost is only counted") {
  LinkedPair pair;
  Effects effects;
  const Message word = make_message(MessageType::information, "ant", "bee", KeepAlive{1});
  pair.ant.core->forwarding().on_own_unsent(word, Errc::queue_full, pair.fleet.now, effects);
  pair.fleet.carry_out(pair.ant, effects);
  pair.fleet.run(Seconds(3));
  CHECK(pair.ant.count("told_again") == 0);
  CHECK(pair.ant.count("dropped.queue_full") == 1);
}
