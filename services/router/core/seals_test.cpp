// Seals between routers: made, checked, and every way in which one can be wrong.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

std::size_t times_logged(const TestNode& node, std::string_view event) {
  return static_cast<std::size_t>(std::count_if(node.log.begin(), node.log.end(),
                                                [&](const std::string& line) { return line.starts_with(event); }));
}

/// ant and bee, linked; bee's mode-adapter takes the messages of ant's robot.
struct SealedPair {
  TestFleet fleet;
  TestNode& ant;
  TestNode& bee;

  explicit SealedPair(bool before_delivery = false)
      : ant(fleet.start("ant")), bee(fleet.start("bee", {.seal_before_delivery = before_delivery})) {
    Effects effects;
    bee.core->bus().on_hello(1, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", fleet.now, effects);
    fleet.carry_out(bee, effects);
    fleet.run(Seconds(1));
    REQUIRE(ant.link_to("bee") != 0);
  }
  void say(const Bytes& data) { fleet.say("ant", "bee", "note", data); }
  /// Changes every seal that ant sends from now on.
  void change_seals(const std::function<void(SealedRange&)>& change, bool sign_again = true) {
    fleet.meddle = [=, this](const std::string& from, LinkId, std::uint64_t&, Message& message) {
      if (from != "ant" || message.subtype != Seal::kSubtype) return true;
      auto range = decode<SealedRange>(decode<Seal>(message.data)->range.payload.bytes);
      change(*range);
      const SigningKey key = sign_again ? ant.keys.identity : make_signing_key();
      message.data = encode(Seal{sign_seal(*range, "ant", fleet.authority.fleet.id(), key)});
      return true;
    };
  }
  /// No seal of ant arrives from now on, and no gap in the numbers of its link shows it.
  void lose_seals() {
    fleet.meddle = [lost = std::map<LinkId, std::uint64_t>()](const std::string& from, LinkId link,
                                                              std::uint64_t& sequence, Message& message) mutable {
      if (from != "ant") return true;
      const bool seal = message.subtype == Seal::kSubtype;
      sequence -= lost[link];
      lost[link] += seal ? 1 : 0;
      return !seal;
    };
  }
  /// Checks that bee raised the alarm and ended the link, and that the two are linked again: ant is still a member.
  void check_alarm(const std::string& reason) {
    const LinkId before = ant.link_to("bee");
    fleet.run(milliseconds(100));
    CHECK(bee.count("refused.seal_" + reason) == 1);
    CHECK(times_logged(bee, "seal_alarm_" + reason + " ") == 1);
    CHECK(bee.link_to("ant") == 0);
    CHECK(ant.link_to("bee") == 0);
    fleet.meddle = nullptr;
    fleet.run(Seconds(3));
    CHECK(ant.link_to("bee") != 0);
    CHECK(ant.link_to("bee") != before);
    CHECK(ant.link_to("bee") == bee.link_to("ant"));
  }
};

}  // namespace

TEST_CASE("what a node says is sealed within 20 ms and checked; an idle link stays up on sealed keep-alives") {
  SealedPair pair;
  const std::uint64_t sent = pair.ant.count("seals.sent");
  const std::uint64_t checked = pair.bee.count("seals.checked");
  pair.say("one");
  pair.say("two");
  pair.fleet.run(milliseconds(50));
  CHECK(pair.ant.count("seals.sent") == sent + 1);
  CHECK(pair.bee.count("seals.checked") == checked + 1);
  CHECK(pair.bee.delivered.size() == 2);
  const LinkId link = pair.ant.link_to("bee");
  pair.fleet.run(Seconds(60));
  CHECK(pair.ant.link_to("bee") == link);
  CHECK(pair.ant.count("seals.sent") == pair.bee.count("seals.checked"));
}

TEST_CASE("a seal leaves 20 ms after the first message that it covers, and no router is awake for nothing") {
  SealedPair pair;
  pair.fleet.run(milliseconds(100));
  const std::uint64_t sent = pair.ant.count("seals.sent");
  const std::uint64_t messages = pair.bee.count("seals.messages");
  const LinkId link = pair.ant.link_to("bee");
  CHECK(*pair.ant.core->next_deadline() > pair.fleet.now.mono);
  CHECK_FALSE(pair.ant.core->seals().make_seal(link, pair.fleet.now).has_value());  // there is nothing to seal
  pair.say("one");
  pair.say("two");
  const MonotonicTime said = pair.fleet.now.mono;
  CHECK(*pair.ant.core->next_deadline() == said + kSealWithin);  // no tick is needed that would only set it
  pair.fleet.run(kStep);
  CHECK(*pair.ant.core->next_deadline() == said + kSealWithin);
  pair.fleet.run(kSealWithin - kStep - kInstant);
  CHECK(pair.ant.count("seals.sent") == sent);
  pair.fleet.run(kInstant);
  CHECK(pair.ant.count("seals.sent") == sent + 1);
  pair.fleet.run(kStep);
  CHECK(pair.bee.count("seals.messages") == messages + 2);
  CHECK(*pair.ant.core->next_deadline() > pair.fleet.now.mono);
}

TEST_CASE("the 64th message calls for its seal at once, though nothing is said after it") {
  SealedPair pair;
  pair.fleet.run(milliseconds(100));
  const std::uint64_t sent = pair.ant.count("seals.sent");
  const MonotonicTime said = pair.fleet.now.mono;
  pair.say("first");
  pair.fleet.run(kStep);
  REQUIRE(*pair.ant.core->next_deadline() == said + kSealWithin);
  for (std::uint32_t i = 2; i < kMaxUnsealed; ++i) pair.say("more");
  CHECK(*pair.ant.core->next_deadline() == said + kSealWithin);
  pair.say("last");
  CHECK(*pair.ant.core->next_deadline() <= pair.fleet.now.mono);
  pair.fleet.run(kStep);
  CHECK(pair.ant.count("seals.sent") == sent + 1);
}

TEST_CASE("a frame that did not leave is taken back: the next one bears its number, and no seal covers it") {
  SealedPair pair;
  const LinkId link = pair.ant.link_to("bee");
  Bytes lost = encode_frame(make_message(MessageType::information, "ant", "bee", RobotFault{}));
  REQUIRE(pair.ant.core->seals().send(link, lost.data(), lost.size(), pair.fleet.now).known);
  pair.ant.core->seals().not_sent(link, Unsent::frame);
  pair.say("one");
  pair.fleet.run(milliseconds(100));
  CHECK(pair.bee.delivered.size() == 1);
  CHECK(pair.bee.link_to("ant") == link);
  // The seal over the last of 64 frames has not left either: it is no longer urgent.
  for (std::size_t i = 0; i < kMaxUnsealed; ++i)
    REQUIRE(pair.ant.core->seals().send(link, lost.data(), lost.size(), pair.fleet.now).known);
  CHECK(pair.ant.core->seals().is_overdue(link));
  pair.ant.core->seals().not_sent(link, Unsent::frame);
  CHECK_FALSE(pair.ant.core->seals().is_overdue(link));
}

TEST_CASE("of a link that is not there nothing is sealed, numbered or heard") {
  SealedPair pair;
  RouterCore& core = *pair.ant.core;
  const LinkId none = 4711;
  Bytes frame = encode_frame(make_message(MessageType::information, "ant", "bee", RobotFault{}));
  const std::uint64_t sent = pair.ant.count("seals.sent");
  CHECK_FALSE(core.seals().send(none, frame.data(), frame.size(), pair.fleet.now).known);
  core.seals().not_sent(none, Unsent::frame);
  CHECK_FALSE(core.seals().is_overdue(none));
  CHECK_FALSE(core.seals().seals_each(none));
  CHECK_FALSE(core.seals().make_seal(none, pair.fleet.now));
  core.seals().not_sent(none, Unsent::behind);
  CHECK(pair.ant.count("seals.sent") == sent);
  CHECK_FALSE(core.seals().holds(none));
  Effects effects;
  const Message early = make_message(MessageType::information, "bee", "ant", RobotFault{});
  CHECK(core.seals().receive(none, header_of(early, 5), frame) == SealFault::none);
  CHECK(effects.list.empty());

  // A link that is closed while something on it is unsealed.
  const LinkId link = pair.ant.link_to("bee");
  REQUIRE(core.seals().send(link, frame.data(), frame.size(), pair.fleet.now).known);
  core.seals().forget(link);
  CHECK(core.seals().find(link) == nullptr);
  core.tick(pair.fleet.now, effects);
}

TEST_CASE("before the peer's Hello nobody knows for whom to seal") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
  fleet.start("bee", {.beacon = false, .seal_before_delivery = true});
  fleet.withhold = [](const std::string& from, const Message&) { return from == "bee"; };
  fleet.run(milliseconds(200));
  REQUIRE_FALSE(ant.dials.empty());
  const LinkId link = ant.dials.back().link;
  REQUIRE(ant.core->seals().find(link) != nullptr);
  CHECK(ant.core->seals().find(link)->writer.unsealed() == 1);  // its Hello
  CHECK_FALSE(ant.core->seals().make_seal(link, fleet.now));
  CHECK_FALSE(ant.core->seals().seals_each(link));
  CHECK(*ant.core->next_deadline() > fleet.now.mono);
  const std::size_t heard = ant.core->seals().find(link)->reader.unsealed();
  Effects effects;
  const Message early = make_message(MessageType::information, "bee", "ant", RobotFault{});
  ant.core->forwarding().from_link(link, header_of(early, 1, link), encode_frame(early), fleet.now, effects);
  CHECK(ant.core->seals().find(link)->reader.unsealed() == heard);
}

TEST_CASE("a signature that is found wrong when its link has ended raises the alarm all the same, and ends no other") {
  SealedPair pair;
  const LinkId link = pair.bee.link_to("ant");
  CheckSeal late;
  late.link = 4711;
  late.signer = std::make_shared<const Certificate>(pair.ant.keys.certificate);
  Effects effects;
  pair.bee.core->forwarding().on_seal_checked(late, false, pair.fleet.now, effects);
  pair.fleet.carry_out(pair.bee, effects);
  CHECK(pair.bee.count("refused.seal_wrong_signature") == 1);
  CHECK(times_logged(pair.bee, "seal_alarm_wrong_signature link 4711 of ant, which has ended: wrong_signature") == 1);
  CHECK(pair.bee.link_to("ant") == link);
  late.link = link;
  const std::uint64_t heard = pair.bee.core->table().link(link)->heard;
  pair.bee.core->forwarding().on_seal_checked(late, false, pair.fleet.now, effects);
  pair.fleet.carry_out(pair.bee, effects);
  CHECK(times_logged(pair.bee, "seal_alarm_wrong_signature link " + std::to_string(link) + " of ant, after sequence " +
                                   std::to_string(heard) + ": wrong_signature") == 1);
  CHECK(pair.bee.link_to("ant") == 0);
}

TEST_CASE("a burst is sealed by the 64") {
  SealedPair pair;
  const std::uint64_t sent = pair.ant.count("seals.sent");
  for (int i = 0; i < 1000; ++i) pair.say("burst");
  pair.fleet.run(milliseconds(100));
  CHECK(pair.bee.delivered.size() == 1000);
  CHECK(pair.ant.count("seals.sent") == sent + 16);
  CHECK(pair.ant.link_to("bee") != 0);
}

TEST_CASE("a seal that is wrong ends the link with an alarm, and the member dials again") {
  SealedPair pair;
  pair.say("one");
  SUBCASE("signed with another key") {
    pair.change_seals([](SealedRange&) {}, false);
    pair.check_alarm("wrong_signature");
  }
  SUBCASE("over other messages") {
    pair.change_seals([](SealedRange& range) { range.hash.bytes[0] = static_cast<char>(range.hash.bytes[0] ^ 1); });
    pair.check_alarm("wrong_hash");
  }
  SUBCASE("over the messages before") {
    pair.change_seals([](SealedRange& range) { --range.first; });
    pair.check_alarm("wrong_range");
  }
  SUBCASE("of another link") {
    pair.change_seals([](SealedRange& range) { ++range.link; });
    pair.check_alarm("wrong_link");
  }
}

TEST_CASE("a message that was changed behind the link's encryption is found by its seal") {
  SealedPair pair;
  pair.say("one");
  pair.fleet.meddle = [](const std::string&, LinkId, std::uint64_t&, Message& message) {
    if (message.subtype == "note") message.data = "two";
    return true;
  };
  pair.check_alarm("wrong_hash");
}

TEST_CASE("seals that stay away are missed at the 65th message, or at the second keep-alive") {
  SealedPair pair;
  pair.lose_seals();
  SUBCASE("many messages") {
    for (int i = 0; i < 100; ++i) pair.say("burst");
    pair.check_alarm("missing");
    CHECK(pair.bee.delivered.size() <= kMaxUnsealed);
  }
  SUBCASE("few messages") {
    pair.say("one");
    for (int i = 0; i < 600 && pair.bee.link_to("ant") != 0; ++i) pair.fleet.run(kStep);
    pair.check_alarm("late");
  }
}

TEST_CASE("before_delivery: a message waits for its seal, and the sender seals each at once") {
  SealedPair pair(true);
  CHECK(pair.bee.core->seals().holds(pair.bee.link_to("ant")));
  const std::uint64_t sent = pair.ant.count("seals.sent");
  for (const char* data : {"one", "two", "three"}) pair.say(data);
  CHECK(pair.bee.delivered.empty());
  pair.fleet.run(milliseconds(30));
  CHECK(pair.ant.count("seals.sent") >= sent + 3);
  REQUIRE(pair.bee.delivered.size() == 3);
  CHECK(pair.bee.delivered[2].data == "three");
  pair.say("four");
  pair.change_seals([](SealedRange& range) { range.hash.bytes[0] = static_cast<char>(range.hash.bytes[0] ^ 1); });
  pair.check_alarm("wrong_hash");
  CHECK(pair.bee.delivered.size() == 3);
}

namespace {

/// Nacks of this code that ant's services received.
std::size_t nacks(const TestNode& node, std::string_view code) {
  return static_cast<std::size_t>(std::count_if(node.delivered.begin(), node.delivered.end(), [&](const Message& one) {
    const auto nack = decode<Nack>(one.data);
    return one.subtype == Nack::kSubtype && nack && nack->code == code;
  }));
}

}  // namespace

TEST_CASE("before_delivery: what waits for a seal when the link ends is counted, told its sender, and not delivered") {
  SealedPair pair(true);
  Effects effects;
  pair.ant.core->bus().on_hello(1, {"mode-adapter", {}, 5, 100, "1"}, "mode-adapter", pair.fleet.now, effects);
  pair.fleet.carry_out(pair.ant, effects);
  pair.fleet.run(milliseconds(100));
  const std::uint64_t sealed = pair.bee.count("seals.checked");
  SUBCASE("its seal is wrong: the link carries the Nacks before its Goodbye, sealed") {
    pair.change_seals([](SealedRange& range) { range.hash.bytes[0] = static_cast<char>(range.hash.bytes[0] ^ 1); });
    pair.fleet.ask("ant", "bee", "greet", "one");
    pair.fleet.run(milliseconds(100));
    CHECK(nacks(pair.ant, "seal_broken") == 1);
    CHECK(pair.ant.count("seals.open_ends") == 0);
  }
  SUBCASE("the connection is gone: nobody can be told, and it is counted") {
    pair.fleet.meddle = [](const std::string& from, LinkId, std::uint64_t&, Message& message) {
      return from != "ant" || message.subtype != Seal::kSubtype;
    };
    pair.fleet.ask("ant", "bee", "greet", "one");
    pair.fleet.run(milliseconds(10));
    Effects ended;
    pair.bee.core->links().on_ended(pair.bee.link_to("ant"), LinkEndReason::disconnected, pair.fleet.now, ended);
    pair.fleet.carry_out(pair.bee, ended);
    CHECK(nacks(pair.ant, "seal_broken") == 0);
  }
  CHECK(pair.bee.count("dropped.seal_broken") == 1);
  CHECK(pair.bee.delivered.empty());
  CHECK(pair.bee.count("seals.checked") == sealed);
}

TEST_CASE("before_delivery: so many bytes wait for a seal and no more") {
  SealedPair pair(true);
  pair.lose_seals();
  const LinkId link = pair.bee.link_to("ant");
  const Bytes large(1'000'000, 'x');
  pair.fleet.run(milliseconds(50));
  REQUIRE(pair.bee.core->seals().find(link)->held == 0);
  for (int i = 0; i < 8; ++i) pair.say(large);
  pair.fleet.run(milliseconds(10));
  // The limit is exact to the byte.
  const std::size_t held = pair.bee.core->seals().find(link)->held;
  const std::size_t around = held / 8 - large.size();
  pair.say(Bytes(kMaxHeldBytes - held - around, 'x'));
  pair.fleet.run(milliseconds(10));
  CHECK(pair.bee.core->seals().find(link)->held == kMaxHeldBytes);
  CHECK(pair.bee.link_to("ant") == link);
  pair.say("x");
  pair.check_alarm("missing");
  CHECK(pair.bee.delivered.empty());
}

TEST_CASE("a Hello that wants not to be sealed, or in a way unknown here, is refused as a downgrade") {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");
  fleet.meddle = [](const std::string& from, LinkId, std::uint64_t&, Message& message) {
    if (from != "ant" || message.subtype != Hello::kSubtype) return true;
    auto hello = decode<Hello>(message.data);
    hello->seal = "off";
    message.data = encode(*hello);
    return true;
  };
  fleet.run(Seconds(1));
  CHECK(bee.count("refused.downgraded") > 0);
  CHECK(ant.link_to("bee") == 0);
}

TEST_CASE("what was said last before a link ends without a word stays unproven, and is counted so") {
  SealedPair pair;
  pair.say("last words");
  pair.fleet.meddle = [](const std::string&, LinkId, std::uint64_t&, Message& message) {
    return message.subtype != Seal::kSubtype;
  };
  pair.fleet.run(milliseconds(10));
  pair.fleet.stop("ant");
  pair.fleet.run(Seconds(11));
  CHECK(pair.bee.count("seals.open_ends") == 1);
  CHECK(times_logged(pair.bee, "open_end ") == 1);
}
