// Answers: accepted only from the node that was asked, and sent to the connection that asked.
#include "services/router/test/test_pair.hpp"

using namespace trb;
using namespace trb::router;

namespace {

Message answer_to_ant(const std::string& source, const std::string& subtype, std::uint64_t asked) {
  return {.type = MessageType::information,
          .subtype = subtype,
          .source = source,
          .target = "ant",
          .id = 3,
          .reply_to = asked,
          .data = {}};
}

}  // namespace

TEST_CASE("an answer goes to the slot that asked, and to no other") {
  RoutedPair pair;
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = pair.slot(1) << 48U | 4U;
  CHECK(pair.ask(2, answer.reply_to, "bee").to == To::peer);
  CHECK(pair.come(answer).connection == 2);
  CHECK(pair.come(answer).connection == 2);  // a second one: done, after handed_over
  answer.reply_to = (pair.slot(1) + 1) << 48U | 4U;
  CHECK(pair.come(answer).reason == Errc::no_service);
}

TEST_CASE("a member that floods answers to what another was asked is refused, the one that was asked is heard") {
  RoutedPair pair;
  pair.fleet.start("cat");
  pair.fleet.run(Seconds(2));
  const std::uint64_t first = pair.slot(0) << 48U;
  CHECK(pair.ask(1, first | 9U, "bee", "stop").to == To::peer);
  const LinkId link = pair.ant.link_to("cat");
  const auto from_cat = [&](const std::string& subtype, std::uint64_t id) {
    const Message answer = answer_to_ant("cat", subtype, id);
    return pair.fleet.arrive(pair.ant, link, pair.ant.core->table().link(link)->heard + 1, answer);
  };
  for (std::uint64_t guess = 0; guess < 16; ++guess) CHECK(from_cat("ack", first | guess).reason == Errc::not_asked);
  CHECK(from_cat("nack", first | 9U).reason == Errc::not_asked);
  CHECK(from_cat("position", first | 9U).reason == Errc::not_asked);
  CHECK(pair.ant.count("refused.not_asked") == 18);
  CHECK(pair.ant.link_to("cat") == link);
  CHECK(pair.ant.log.back() ==
        "not_asked cat sent position as an answer to what 'mode-adapter' of ant did not ask of it");
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = first | 9U;
  CHECK(pair.come(answer).connection == 1);
  answer.reply_to = first | 8U;  // it was asked, but not with that id
  CHECK(pair.come(answer).reason == Errc::not_asked);
}

TEST_CASE("on the bus only the connection that got the question answers it") {
  RoutedPair pair;
  pair.hello(3, "fault-tally", {"tally"});
  const std::uint64_t id = pair.slot(1) << 48U | 77U;
  CHECK(pair.ask(2, id, "ant", "stop").connection == 1);
  const auto from = [&](ConnectionId connection, std::size_t welcome) {
    Message answer{.type = MessageType::information,
                   .subtype = "ack",
                   .source = "ant",
                   .target = "ant",
                   .id = pair.slot(welcome) << 48U | 5U,
                   .reply_to = id,
                   .data = {}};
    const Routing way = pair.ant.core->routing().from_bus(connection, header_of(answer));
    Effects effects;
    if (way.to == To::drop) pair.ant.core->bus().nack(connection, header_of(answer), way.reason, effects);
    pair.fleet.carry_out(pair.ant, effects);
    return way;
  };
  CHECK(from(3, 2).reason == Errc::not_asked);
  CHECK(pair.ant.count("refused.not_asked") == 1);
  CHECK(pair.ant.log.back() ==
        "not_asked service 'fault-tally' (pid 100) said ack as an answer to what 'scheduler' did not ask of it");
  CHECK(pair.nacks() == 0);
  CHECK(from(1, 0).connection == 2);
  CHECK(from(1, 0).connection == 2);
  Message remote = pair.remote("ack", MessageType::information);
  remote.reply_to = id;
  CHECK(pair.come(remote).reason == Errc::not_asked);
}

TEST_CASE("who comes anew has asked nothing; who says hello again still waits") {
  RoutedPair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  Message answer = pair.remote("ack", MessageType::information);
  answer.reply_to = id;
  CHECK(pair.ask(2, id, "bee").to == To::peer);
  pair.hello(2, "scheduler", {"baton", "execution_state"});  // its router's answer was slow
  CHECK(pair.slot(2) == pair.slot(1));
  CHECK(pair.come(answer).connection == 2);
  pair.ant.core->on_connection_gone(2, pair.fleet.now, *std::make_unique<Effects>());
  CHECK(pair.come(answer).reason == Errc::no_service);
  // A slot is reused after 65,535 others: its new holder has requested nothing.
  for (int i = 0; i < 65'535; ++i) {
    Effects effects;
    pair.ant.core->bus().on_hello(100, {"cli", {}, static_cast<std::uint64_t>(i) + 10, 100, "1"}, kProbe,
                                  pair.fleet.now, effects);
    const auto slot = decode<ServiceWelcome>(std::get<BusSend>(effects.list.at(0)).message.data)->slot;
    REQUIRE(slot != 0);
    if (slot != id >> 48U) continue;
    CHECK(pair.come(answer).reason == Errc::not_asked);
    return;
  }
  FAIL("the slot was not given again");
}

TEST_CASE("a user's information may be Nacked by whom it went to, and is answered by nobody") {
  RoutedPair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  CHECK(pair.ask(2, id, "bee", "greeting", MessageType::information).to == To::peer);
  Message answer = pair.remote("nack", MessageType::information);
  answer.reply_to = id;
  CHECK(pair.come(answer).connection == 2);
  answer.subtype = "ack";
  CHECK(pair.come(answer).reason == Errc::not_asked);
  CHECK(pair.ask(2, id + 1, "bee", "task_progress", MessageType::information).to == To::peer);
  answer.subtype = "nack";
  answer.reply_to = id + 1;
  CHECK(pair.come(answer).reason == Errc::not_asked);
  CHECK(pair.ask(2, id + 2, "*", "greeting", MessageType::information).to == To::every_peer);
  answer.reply_to = id + 2;
  CHECK(pair.come(answer).reason == Errc::not_asked);
}

TEST_CASE("by a relay, too, only whom was asked answers, and not the relay itself") {
  TestFleet fleet;
  for (const char* one : {"ant", "bee", "cat"}) {
    for (const char* other : {"ant", "bee", "cat"}) {
      if (one != other) fleet.cut(one, other);
    }
  }
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("cat", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(5));
  Effects effects;
  ant.core->bus().on_hello(1, {"scheduler", {"baton"}, 5, 100, "1"}, "scheduler", fleet.now, effects);
  const auto slot = decode<ServiceWelcome>(std::get<BusSend>(effects.list.back()).message.data)->slot;
  const std::uint64_t id = static_cast<std::uint64_t>(slot) << 48U | 9U;
  Message stop{.type = MessageType::command, .subtype = "stop", .source = "ant", .target = "bee", .id = id, .data = {}};
  REQUIRE(ant.core->routing().from_bus(1, header_of(stop)).to == To::relay);
  const auto by_relay = [&](const std::string& from, const std::string& subtype) {
    const Message answer = answer_to_ant(from, subtype, id);
    auto relaying = fleet.at(from).core->relays().wrap(0, "ant", header_of(answer), encode_frame(answer), fleet.now);
    REQUIRE(relaying.ok());
    Effects out;
    out.add(LinkSend{relaying->link, relaying->message});
    fleet.carry_out(fleet.at(from), out);
    fleet.run(Seconds(1));
    return ant.told(subtype);
  };
  CHECK(by_relay("cat", "ack") == 0);
  CHECK(ant.count("refused.not_asked") == 1);
  CHECK(by_relay("bee", "ack") == 1);
  const auto by_cloud = [&](const std::string& subtype) {
    const Message answer = answer_to_ant("cloud", subtype, id);
    const LinkId link = ant.link_to("cloud");
    return fleet.arrive(ant, link, ant.core->table().link(link)->heard + 1, answer);
  };
  CHECK(by_cloud("ack").reason == Errc::not_asked);
  CHECK(by_cloud("nack").reason == Errc::not_asked);
  CHECK(cloud.count("refused.not_asked") == 0);
}

TEST_CASE("what is an answer, has no number or may be lost has asked nothing") {
  RoutedPair pair;
  const std::uint64_t id = pair.slot(1) << 48U | 4U;
  Message answer = pair.remote("nack", MessageType::information);
  const auto said = [&](std::uint64_t number, const std::function<void(Message&)>& change) {
    Message message{.type = MessageType::information,
                    .subtype = "greeting",
                    .source = "ant",
                    .target = "bee",
                    .id = number,
                    .data = {}};
    change(message);
    REQUIRE(pair.ant.core->routing().from_bus(2, header_of(message)).to == To::peer);
    answer.reply_to = number;
    return pair.come(answer);
  };
  CHECK(said(id, [](Message&) {}).connection == 2);
  CHECK(said(id + 1, [](Message& message) { message.reply_to = 5; }).reason == Errc::not_asked);
  CHECK(said(id + 2, [](Message& message) { message.flags = kFlagLossy; }).reason == Errc::not_asked);
}
