// Rights at the router: by the role in the peer's certificate, and by the own role before it signs.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct PairOfRole {
  TestFleet fleet;
  TestNode* ant = nullptr;
  explicit PairOfRole(Role bee_role) {
    fleet.keys("bee") = fleet.authority.sign_node("bee", bee_role);
    ant = &fleet.start("ant");
    fleet.start("bee");
    fleet.run(Seconds(2));
    REQUIRE(ant->link_to("bee") != 0);
  }
  template <class T>
  Errc hear(MessageType type, const T& body) {
    const LinkId link = ant->link_to("bee");
    const std::uint64_t next = ant->core->table().link(link)->heard + 1;
    return fleet.arrive(*ant, link, next, make_message(type, "bee", "ant", body)).reason;
  }
};

}  // namespace

TEST_CASE("what only a robot can know is taken from a robot's node, and not from the cloud's") {
  PairOfRole robot(Role::robot);
  CHECK(robot.hear(MessageType::information, RobotFault{}) == Errc::no_service);  // allowed; no service takes it here
  PairOfRole cloud(Role::cloud);
  CHECK(cloud.hear(MessageType::information, RobotFault{}) == Errc::not_permitted);
  CHECK(cloud.ant->count("refused.not_permitted") == 1);
  CHECK(std::find(
            cloud.ant->log.begin(), cloud.ant->log.end(),
            "not_permitted bee sent robot_fault, which a cloud node may not send to another node: trb help rights") !=
        cloud.ant->log.end());
}

TEST_CASE("what belongs to a node's own bus is taken from no link") {
  PairOfRole pair(Role::cloud);
  CHECK(pair.hear(MessageType::command, Execute{}) == Errc::not_permitted);
  CHECK(pair.hear(MessageType::information, PeerExpired{"ant", "a lie"}) == Errc::not_permitted);
  CHECK(pair.hear(MessageType::information, ServiceWelcome{}) == Errc::not_permitted);
  CHECK(pair.hear(MessageType::information, SignedRecord{}) == Errc::not_permitted);
  CHECK(pair.ant->count("refused.not_permitted") == 4);
}

TEST_CASE("a robot's router signs no decision, whoever asks") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  Effects effects;
  ant.core->bus().on_hello(1, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
  ant.core->bus().on_hello(2, {"resilience", {}, 1, 1, "1"}, "resilience", fleet.now, effects);
  for (const ConnectionId asking : {1U, 2U}) {
    ant.bus.clear();
    effects = {};
    const Message ask = make_message(MessageType::request, "ant", "ant", SignRequest{std::string(kSignedDecision), {}});
    ant.core->forwarding().on_bus_message(asking, ask, fleet.now, effects);
    fleet.carry_out(ant, effects);
    REQUIRE(ant.bus.size() == 1);
    CHECK(decode<Nack>(ant.bus[0].message.data)->code == "not_permitted");
  }
  CHECK(ant.count("refused.not_permitted") == 2);
}

TEST_CASE("a service that is not the scheduler commands no skill, and a probe cannot tell of an outcome") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  Effects effects;
  ant.core->bus().on_hello(1, {"cli", {}, 1, 1, "1"}, kProbe, fleet.now, effects);
  ant.core->bus().on_hello(2, {"mode-adapter", {"execute"}, 1, 1, "1"}, "mode-adapter", fleet.now, effects);
  ant.core->bus().on_hello(3, {"scheduler", {"outcome"}, 1, 1, "1"}, "scheduler", fleet.now, effects);
  fleet.carry_out(ant, effects);
  std::map<ConnectionId, std::uint64_t> slots;
  for (const auto& send : ant.bus) {
    if (auto welcome = decode<ServiceWelcome>(send.message.data)) slots[send.to] = welcome->slot;
  }
  const auto say = [&](ConnectionId from, const Message& word) {
    Message message = word;
    message.id = (slots.at(from) << 48U) + 1;
    const Bytes frame = encode_frame(message);
    return ant.core->routing().from_bus(from, *decode_frame(frame));
  };
  const Message execute = make_message(MessageType::command, "ant", "ant", Execute{});
  const Message outcome = make_message(MessageType::information, "ant", "ant", Outcome{});
  CHECK(say(3, execute).connection == 2);
  CHECK(say(2, outcome).connection == 3);
  CHECK(say(1, execute).reason == Errc::not_permitted);
  CHECK(say(1, outcome).reason == Errc::not_permitted);
  CHECK(say(3, outcome).reason == Errc::not_permitted);
}
