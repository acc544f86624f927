// What arrives by a relay: profiles, requests to the router, copies. Time is injected, nothing sleeps.
#include "services/router/test/test_relays.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a profile goes to who is reached by a relay, by its own word, at once and at each change") {
  Triangle three;
  Effects effects;
  effects.list.clear();
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects said;
    three.ant->core->bus().on_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
    three.ant->core->forwarding().on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile),
                                                 three.fleet.now, said);
    three.fleet.carry_out(*three.ant, said);
    three.fleet.run(milliseconds(1200));
  };
  tell("ur3");
  CHECK(three.bee->peer("ant")->profile.model == "ur3");
  tell("ur5");
  CHECK(three.bee->peer("ant")->profile.model == "ur5");
}

TEST_CASE("a word by a relay that names a host instead of numbers is refused, and its sender not dialled there") {
  Triangle three;
  RelayAlive alive;
  alive.address = "hub.example:45000";
  Message word = make_message(MessageType::information, "ant", "bee", alive);
  word.remaining_ms = 5000;
  three.hand_to_bee(three.signed_by_ant(three.frame(1, word)));
  CHECK(three.bee->count("refused.relayed_bad_value") == 1);
  CHECK(three.bee->peer("ant")->address == three.fleet.address("ant"));
}

TEST_CASE("by a relay a router is asked for its tables, hears who listens, and says when nobody takes a message") {
  Triangle three;
  Effects effects;
  three.bee->core->bus().on_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                  effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  CHECK(three.bee->told("robot_fault") == 1);
  CHECK(three.bee->count("dropped.no_service") == 0);  // a service took it

  const auto ask = [&](const std::string& word, const Bytes& data, MessageType type) {
    Message question = three.command(*three.ant);
    question.type = type;
    question.subtype = word;
    question.data = data;
    const Routing way = three.ant->core->routing().from_bus(1, header_of(question));
    REQUIRE(way.to == Routing::To::relay);
    three.put(*three.ant, "cloud", three.wrap(question).message);
    three.fleet.run(milliseconds(200));
  };
  ask(std::string(RouteListRequest::kSubtype), encode(RouteListRequest{}), MessageType::request);
  CHECK(three.ant->told(RouteTable::kSubtype) == 1);
  ask(std::string(EchoRequest::kSubtype), encode(EchoRequest{{"ping"}}), MessageType::request);
  CHECK(three.ant->told(Echo::kSubtype) == 1);
  ask("unknown_thing", "x", MessageType::command);
  CHECK(three.bee->count("dropped.no_service") == 1);
  CHECK(Triangle::nacks(*three.ant) == std::vector<std::string>{"no_service"});
}

TEST_CASE("of a profile that changes often one is told in a second by a relay, the newest") {
  Triangle three;
  Effects said;
  three.ant->core->bus().on_hello(2, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", three.fleet.now, said);
  three.fleet.carry_out(*three.ant, said);
  std::size_t sent = 0;
  const auto tell = [&](const std::string& model) {
    NodeProfile profile;
    profile.model = model;
    Effects effects;
    three.ant->core->forwarding().on_bus_message(2, make_message(MessageType::information, "ant", "ant", profile),
                                                 three.fleet.now, effects);
    three.fleet.carry_out(*three.ant, effects);
    three.fleet.run(5 * kStep);
  };
  tell("a");
  three.fleet.run(Seconds(2));
  REQUIRE(three.bee->peer("ant")->profile.model == "a");
  tell("b");
  CHECK(three.bee->peer("ant")->profile.model == "b");
  for (const char* model : {"c", "d", "e"}) tell(model);
  CHECK(three.bee->peer("ant")->profile.model == "b");
  const std::uint64_t before = three.bee->count("relayed.received");
  three.fleet.run(Seconds(1));
  CHECK(three.bee->peer("ant")->profile.model == "e");
  sent = three.bee->count("relayed.received") - before;
  CHECK(sent == 1);
}

TEST_CASE("a word by a relay that one service takes and another hears comes to both") {
  Triangle three;
  Effects effects;
  three.bee->core->bus().on_hello(3, {"resilience", {}, 5, 100, "1", {"robot_fault"}}, "resilience", three.fleet.now,
                                  effects);
  three.bee->core->bus().on_hello(4, {"cloud-gateway", {"robot_fault"}, 6, 100, "1"}, "cloud-gateway", three.fleet.now,
                                  effects);
  three.fleet.carry_out(*three.bee, effects);
  three.put(*three.ant, "cloud",
            three.wrap(make_message(MessageType::information, "ant", "bee", RobotFault{})).message);
  three.fleet.run(milliseconds(100));
  std::string heard;
  for (const BusSend& send : three.bee->bus) {
    if (send.message.subtype == RobotFault::kSubtype) heard += std::to_string(send.to) + " ";
  }
  CHECK(heard == "3 4 ");
}

TEST_CASE("an invitation that is refused by a relay is answered with its reason, as by a link") {
  Triangle three;
  Message order = three.command(*three.ant);
  order.type = MessageType::request;
  order.subtype = RouteListRequest::kSubtype;
  order.data = encode(RouteListRequest{});
  REQUIRE(three.ant->core->routing().from_bus(1, header_of(order)).to == Routing::To::relay);  // it is waited for
  order.subtype = HoldInvitation::kSubtype;
  order.data = encode(HoldInvitation{{"invitation", "", {"x"}, {"y"}}, 1, {"offer"}, false});
  three.put(*three.ant, "cloud", three.wrap(order).message);
  three.fleet.run(milliseconds(200));
  CHECK(three.bee->count("refused.not_permitted") == 1);
  CHECK(Triangle::nacks(*three.ant) == std::vector<std::string>{"not_permitted"});
}
