// What peers request from this router itself, and how much of it they get.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a member that asks for tables without end is told no more than its bytes of a second, by name") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  fleet.start("bee");
  fleet.start("cat");
  fleet.run(Seconds(1));
  const auto ask = [&](const std::string& who, const auto& question) {
    const LinkId link = ant.link_to(who);
    const std::uint64_t next = ant.core->table().link(link)->heard + 1;
    Effects effects;
    ant.core->inbox().on_message(link, ant.core->table().link(link)->key,
                                 make_message(MessageType::request, who, "ant", question), next, fleet.now, effects);
    for (const Effect& effect : effects.list) {
      if (const auto* send = std::get_if<LinkSend>(&effect)) return send->message;
    }
    return Message{};
  };
  std::size_t bytes = 0;
  Message answer;
  for (int i = 0; i < 100'000 && answer.subtype != Nack::kSubtype; ++i) {
    answer = ask("bee", RouteListRequest{});
    bytes += answer.data.size();
  }
  REQUIRE(answer.subtype == Nack::kSubtype);
  CHECK(decode<Nack>(answer.data)->code == "queue_full");
  CHECK(bytes > kAnsweredOfOne);
  CHECK(bytes < kAnsweredOfOne + (2U << 10U) * 10);
  CHECK(ask("bee", RouterCountersRequest{}).subtype == Nack::kSubtype);
  // An echo is no longer than its request; another member has a budget of its own.
  CHECK(ask("bee", EchoRequest{}).subtype == Echo::kSubtype);
  CHECK(ask("cat", RouteListRequest{}).subtype == RouteTable::kSubtype);
  fleet.run(Seconds(1));
  CHECK(ask("bee", RouteListRequest{}).subtype == RouteTable::kSubtype);
}

TEST_CASE("what a peer may not ask is Nacked if it asks, and not if it only tells or answers") {
  TestFleet fleet;
  TestNode& ant = fleet.start_two(Seconds(1));
  const LinkId link = ant.link_to("bee");
  const auto nacks = [&](const Message& message) {
    Effects effects;
    ant.core->inbox().on_message(link, ant.core->table().link(link)->key, message, 99, fleet.now, effects);
    for (const std::string& name : effects.counts) ant.core->counters().count(name);
    return std::count_if(effects.list.begin(), effects.list.end(), [](const Effect& effect) {
      const auto* send = std::get_if<LinkSend>(&effect);
      return send != nullptr && send->message.subtype == Nack::kSubtype;
    });
  };
  Message message = make_message(MessageType::request, "bee", "ant", ServiceHello{});
  CHECK(nacks(message) == 1);
  CHECK(ant.count("refused.not_permitted") == 1);
  message.data = "noise";
  CHECK(nacks(message) == 1);
  message.reply_to = 5;
  CHECK(nacks(message) == 0);
  message.reply_to = 0;
  message.type = MessageType::information;
  CHECK(nacks(message) == 0);
}
