// Who is notified that a message was not delivered, and how it is counted.
#include "services/router/test/test_pair.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("what was said to every node is not Nacked back by each") {
  RoutedPair pair;
  Effects effects;
  Message word = pair.remote("greeting", MessageType::information);
  word.target = "*";
  pair.ant.core->forwarding().on_undelivered(pair.ant.link_to("bee"), header_of(word), Errc::queue_full, effects);
  CHECK(effects.list.empty());
}

TEST_CASE("a Nack answers commands, requests and the user's own information, never an answer or typed information") {
  RoutedPair pair;
  const auto nack = [&](const Message& message) {
    Effects effects;
    pair.ant.core->bus().nack(1, header_of(message), Errc::unknown_target, effects);
    pair.fleet.carry_out(pair.ant, effects);
    return pair.nacks();
  };
  CHECK(nack(pair.local("cat", "move")) == 1);
  CHECK(nack(pair.local("cat", "pose", MessageType::information)) == 2);
  CHECK(nack(pair.local("cat", "task_progress", MessageType::information)) == 2);
  CHECK(nack(pair.local("cat", "nack", MessageType::information)) == 2);
  Message answer = pair.local("cat", "pose", MessageType::information);
  answer.reply_to = 4;
  CHECK(nack(answer) == 2);
  const Message& last = pair.ant.bus.back().message;
  CHECK(last.reply_to == pair.local("cat", "move").id);
  CHECK(decode<Nack>(last.data)->code == "unknown_target");
}

TEST_CASE("a peer is Nacked what it waits for, in its own name, by its own link, and refusals are counted apart") {
  RoutedPair pair;
  const LinkId link = pair.ant.link_to("bee");
  const auto nacked = [&](LinkId by, const Message& message, Errc reason) {
    Effects effects;
    pair.ant.core->forwarding().on_undelivered(by, header_of(message), reason, effects);
    for (const std::string& name : effects.counts) pair.ant.core->counters().count(name);
    if (effects.list.empty()) return std::string();
    const auto& send = std::get<LinkSend>(effects.list.at(0));
    CHECK(send.link == by);
    CHECK(send.message.reply_to == message.id);
    return decode<Nack>(send.message.data)->code;
  };
  CHECK(nacked(link, pair.remote("move"), Errc::no_service) == "no_service");
  CHECK(nacked(4711, pair.remote("move"), Errc::no_service).empty());
  Message forged = pair.remote("move");
  forged.source = "cat";
  CHECK(nacked(link, forged, Errc::source_mismatch).empty());
  Message nameless = pair.remote("move");
  nameless.id = 0;
  CHECK(nacked(link, nameless, Errc::no_service).empty());
  CHECK(pair.ant.count("dropped.no_service") == 3);
  for (const Errc reason : {Errc::source_mismatch, Errc::not_permitted, Errc::unknown_peer_key, Errc::not_asked}) {
    const std::string name = "refused." + std::string(errc_name(reason));
    const std::uint64_t before = pair.ant.count(name);
    nacked(link, pair.remote("move"), reason);
    CHECK(pair.ant.count(name) == before + 1);
  }
}

TEST_CASE("a service that says what is not its word is named in the log, and what nobody takes is only dropped") {
  RoutedPair pair;
  const auto nack = [&](ConnectionId from, Errc reason) {
    Effects effects;
    pair.ant.log.clear();
    pair.ant.core->bus().nack(from, header_of(pair.local("bee", "execute")), reason, effects);
    pair.fleet.carry_out(pair.ant, effects);
  };
  nack(2, Errc::not_permitted);
  CHECK(pair.ant.count("refused.not_permitted") == 1);
  REQUIRE(pair.ant.log.size() == 1);
  CHECK(pair.ant.log[0] ==
        "not_permitted service 'scheduler' (pid 100) said execute, which is not its word: trb help rights");
  nack(99, Errc::not_permitted);
  CHECK(pair.ant.log.empty());
  nack(2, Errc::unknown_target);
  CHECK(pair.ant.count("dropped.unknown_target") == 1);
  CHECK(pair.ant.log.empty());
}
