// The lossy lane: who receives it, what is accepted from it, and what happens to a stream without one.
#include <doctest/doctest.h>

#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// Ant has sensors; bee watches them, with a service on connection 1.
struct Stream {
  TestFleet fleet;
  TestNode& ant;
  TestNode& bee;

  explicit Stream(const TestFleet::Options& of_ant = {}) : ant(fleet.start("ant", of_ant)), bee(fleet.start("bee")) {
    fleet.run(Seconds(2));
    Effects effects;
    bee.core->bus().on_hello(1, {"scheduler", {"baton"}, 5, 100, "1"}, "scheduler", fleet.now, effects);
    fleet.carry_out(bee, effects);
    Message watch = make_message(MessageType::request, "bee", "ant", SensorWatch{});
    watch.id = asked_id();
    CHECK(bee.core->routing().from_bus(1, header_of(watch)).to == To::peer);
  }
  [[nodiscard]] std::uint64_t asked_id() const {
    for (const BusSend& send : bee.bus) {
      if (send.message.subtype == ServiceWelcome::kSubtype)
        return static_cast<std::uint64_t>(decode<ServiceWelcome>(send.message.data)->slot) << 48U | 5U;
    }
    return 0;
  }
  /// A value that answers the request of bee's service.
  [[nodiscard]] Message value(const std::string& from = "ant") const {
    Message message = make_message(MessageType::information, from, "bee", SensorReading{});
    message.flags = kFlagLossy;
    message.reply_to = asked_id();
    return message;
  }
  /// How bee routes a message that came by ant's lane.
  Routing come(const Message& message) {
    Effects effects;
    const Routing taken = bee.core->routing().from_lane(bee.link_to("ant"), header_of(message), effects);
    fleet.carry_out(bee, effects);
    return taken;
  }
  bool admits(const TestKeys& keys) {
    Effects effects;
    const bool good = ant.core->lanes().admit(keys.link.public_key, effects);
    fleet.carry_out(ant, effects);
    return good;
  }
  std::optional<LinkId> listens(const std::string& who, BytesView topic) {
    Effects effects;
    const auto link = ant.core->lanes().on_listen(fleet.keys(who).link.public_key, topic, effects);
    fleet.carry_out(ant, effects);
    return link;
  }
};

}  // namespace

TEST_CASE("each end of a link hears the other's lane, and a stream goes by it beside the link") {
  Stream stream;
  CHECK(stream.fleet.receives_lane("bee", "ant"));
  CHECK(stream.fleet.receives_lane("ant", "bee"));
  const std::uint64_t heard = stream.bee.core->table().link(stream.bee.link_to("ant"))->heard;
  for (int i = 0; i < 1000; ++i) CHECK(stream.fleet.stream("ant", stream.value()).to == To::lane);
  CHECK(stream.bee.delivered.size() == 1000);
  CHECK(stream.bee.core->table().link(stream.bee.link_to("ant"))->heard == heard);
}

TEST_CASE("a lane is dialled after its link, and again when it has broken, ever less often") {
  Stream stream;
  REQUIRE(stream.bee.lane_dials.size() == 1);
  CHECK(stream.bee.lane_dials[0].address == "10.0.0.1:45001");
  stream.fleet.run(Seconds(20));
  CHECK(stream.bee.lane_dials.size() == 1);
  stream.fleet.break_lane("bee", "ant");
  CHECK(stream.fleet.stream("ant", stream.value()).to == To::peer);
  stream.fleet.run(std::chrono::milliseconds(250));
  CHECK(stream.fleet.receives_lane("bee", "ant"));

  stream.fleet.cut("bee", "ant");
  stream.fleet.break_lane("bee", "ant");
  CHECK_FALSE(stream.fleet.receives_lane("bee", "ant"));
}

TEST_CASE("the lane ends with its link, and comes back with it") {
  Stream stream;
  const LinkId old = stream.bee.link_to("ant");
  stream.fleet.move("ant", "10.0.1.1:45000");
  CHECK_FALSE(stream.fleet.receives_lane("bee", "ant"));
  stream.ant.core->set_lane("10.0.1.1:45001");
  stream.fleet.run(Seconds(4));
  CHECK(stream.bee.link_to("ant") != old);
  CHECK(stream.fleet.receives_lane("bee", "ant"));
  CHECK(stream.fleet.receives_lane("ant", "bee"));
  stream.fleet.stop("ant");
  CHECK(stream.bee.lane_dials.size() == 2);
  stream.fleet.run(Seconds(5));
  CHECK(stream.bee.lane_dials.size() == 2);
}

TEST_CASE("only the key of a peer whose link is up may listen, and only for its own name") {
  Stream stream;
  CHECK_FALSE(stream.admits(stream.fleet.keys("cat")));  // a member, never linked
  const TestAuthority elsewhere;
  CHECK_FALSE(stream.admits(elsewhere.sign_node("bee")));
  CHECK(stream.ant.count("refused.lane_key") == 2);
  CHECK(stream.admits(stream.bee.keys));
  CHECK(stream.listens("bee", topic_of("bee")) == stream.ant.link_to("bee"));

  stream.fleet.start("be");
  stream.fleet.run(Seconds(3));
  for (const Bytes& topic : {topic_of("bee"), Bytes("be"), Bytes("b"), Bytes(), topic_of("ant"), Bytes("be\0x", 4)})
    CHECK_FALSE(stream.listens("be", topic));
  CHECK(stream.ant.count("refused.lane_topic") == 6);
  CHECK_FALSE(stream.listens("cat", topic_of("cat")));
  CHECK(stream.ant.count("refused.lane_key") == 3);
  stream.fleet.stop("bee");
  stream.fleet.run(Seconds(11));
  CHECK_FALSE(stream.admits(stream.fleet.keys("bee")));
}

TEST_CASE("who talks to the lane instead of listening is kept out as long as its link lasts") {
  Stream stream;
  Effects effects;
  stream.ant.core->lanes().bar(stream.bee.keys.link.public_key, effects);
  stream.fleet.carry_out(stream.ant, effects);
  CHECK(stream.ant.count("refused.lane_word") == 1);
  CHECK_FALSE(stream.admits(stream.bee.keys));
  CHECK_FALSE(stream.listens("bee", topic_of("bee")));
  CHECK(stream.fleet.stream("ant", stream.value()).to == To::peer);
  CHECK(stream.ant.link_to("bee") != 0);
}

TEST_CASE("what comes by a lane is its peer's own lossy information for this node, and nothing else") {
  Stream stream;
  CHECK(stream.come(stream.value()).connection == 1);
  Effects effects;
  CHECK(stream.bee.core->routing().from_lane(4711, header_of(stream.value()), effects).reason ==
        Errc::unknown_peer_key);
  Message other = stream.value("cat");
  CHECK(stream.come(other).reason == Errc::source_mismatch);
  other = stream.value();
  other.target = "cat";
  CHECK(stream.come(other).reason == Errc::unknown_target);
  other = stream.value();
  other.flags = 0;
  CHECK(stream.come(other).reason == Errc::bad_value);
  other = stream.value();
  other.type = MessageType::command;
  CHECK(stream.come(other).reason == Errc::bad_value);
  other = stream.value();
  other.remaining_ms = 0;
  CHECK(stream.come(other).reason == Errc::expired);
  other = stream.value();
  other.reply_to = 0;
  for (const char* word : {"keep_alive", "goodbye", "hello", "node_profile", "outcome", "peer_expired", "route_list"}) {
    CAPTURE(word);
    other.subtype = word;
    CHECK(stream.come(other).reason == Errc::not_permitted);
  }
  CHECK(stream.bee.count("refused.lane_source_mismatch") == 1);
  CHECK(stream.bee.count("refused.lane_wrong_target") == 1);
  CHECK(stream.bee.count("refused.lane_not_lossy") == 2);
  CHECK(stream.bee.count("refused.lane_not_permitted") == 7);
  CHECK(stream.bee.count("dropped.expired") == 1);
  CHECK(stream.bee.told(Nack::kSubtype) + stream.ant.told(Nack::kSubtype) == 0);
}

TEST_CASE("a stream that nobody asked for is refused by a lane as it is by a link") {
  Stream stream;
  Message value = stream.value();
  value.reply_to += 1;
  CHECK(stream.come(value).reason == Errc::not_asked);
  CHECK(stream.bee.count("refused.not_asked") == 1);
  CHECK(stream.bee.log.back().find("not_asked ant sent sensor_reading") == 0);

  TestNode& cat = stream.fleet.start("cat");
  stream.fleet.run(Seconds(2));
  Effects effects;
  CHECK(
      stream.bee.core->routing().from_lane(stream.bee.link_to("cat"), header_of(stream.value("cat")), effects).reason ==
      Errc::not_asked);
  CHECK(stream.fleet.receives_lane("bee", "cat"));
  CHECK(cat.delivered.empty());
}

TEST_CASE("a peer that does not listen gets a stream by its link, and of a flood no more than that") {
  Stream stream(TestFleet::Options{.lane = false});
  CHECK_FALSE(stream.fleet.receives_lane("bee", "ant"));
  CHECK(stream.fleet.receives_lane("ant", "bee"));
  for (int i = 0; i < 100; ++i) stream.fleet.stream("ant", stream.value());
  stream.fleet.run(Seconds(1));
  CHECK(stream.bee.delivered.size() == Spare::kMessages);
  CHECK(stream.ant.count("dropped.no_lane") == 100 - Spare::kMessages);
  Message image = stream.value();
  CHECK(stream.fleet.stream("ant", image).to == To::peer);
  image.data.resize(Spare::kBytes);
  CHECK(stream.fleet.stream("ant", image).to == To::drop);
}

TEST_CASE("a stream to who is reached by a relay goes by it, and of a flood no more than that") {
  TestFleet fleet;
  fleet.cut("ant", "bee");
  fleet.cut("bee", "ant");
  TestNode& cloud = fleet.start("cloud", {.beacon = false, .relay = true});
  TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"cloud"}});
  fleet.start("bee", {.beacon = false, .seeds = {"cloud"}});
  fleet.run(Seconds(3));
  Message value = make_message(MessageType::information, "ant", "bee", SensorReading{});
  value.flags = kFlagLossy;
  for (int i = 0; i < 100; ++i) {
    const Routing way = fleet.stream("ant", value);
    CHECK(way.to == (i < 20 ? To::relay : To::drop));
    CHECK(way.link == (i < 20 ? ant.link_to("cloud") : 0));
  }
  CHECK(ant.count("dropped.no_lane") == 80);
  for (int second = 0; second < 5; ++second) {
    fleet.run(Seconds(1));
    CHECK(fleet.stream("ant", value).to == To::relay);
  }
  value.target = "cloud";
  CHECK(fleet.stream("ant", value).to == To::lane);
  CHECK(cloud.count("refused.lane_topic") == 0);
}

TEST_CASE("nobody is told of lossy information that was dropped, not even of the user's own") {
  Stream stream;
  Message lost = stream.value();
  lost.subtype = "pose";
  lost.reply_to = 0;
  Effects effects;
  stream.bee.core->forwarding().on_undelivered(stream.bee.link_to("ant"), header_of(lost), Errc::queue_full, effects);
  stream.bee.core->bus().nack(1, header_of(lost), Errc::queue_full, effects);
  CHECK(effects.list.empty());
  CHECK(effects.counts == std::vector<std::string>{"dropped.queue_full", "dropped.queue_full"});
}

TEST_CASE("what a peer gets by its link instead of the lane is bounded to the byte, for a second") {
  Spare spare;
  const MonotonicTime now{1'000'000'000};
  CHECK(spare.take(Spare::kBytes, now));
  CHECK_FALSE(spare.take(1, now + std::chrono::milliseconds(999)));
  CHECK(spare.take(1, now + Seconds(1)));
}

TEST_CASE("a lane that breaks again and again is dialled ever less often; one that was heard for long at once") {
  Stream stream;
  const auto comes_back_after = [&](Duration wait) {
    stream.fleet.break_lane("bee", "ant");
    stream.fleet.run(wait - 2 * kStep);
    CHECK_FALSE(stream.fleet.receives_lane("bee", "ant"));
    stream.fleet.run(3 * kStep);
    CHECK(stream.fleet.receives_lane("bee", "ant"));
  };
  comes_back_after(milliseconds(200));
  comes_back_after(milliseconds(400));
  comes_back_after(milliseconds(800));
  CHECK(stream.bee.count("lane.disconnected") == 3);
  stream.fleet.run(Seconds(11));
  comes_back_after(milliseconds(200));
}

TEST_CASE("a lane is dialled half a second after its link, to the moment; one that a peer has not is never") {
  for (const bool lane : {true, false}) {
    CAPTURE(lane);
    TestFleet fleet;
    TestNode& ant = fleet.start("ant", {.beacon = false, .seeds = {"bee"}});
    fleet.start("bee", {.beacon = false, .lane = lane});
    while (ant.link_to("bee") == 0) fleet.run(kOnTheWay);
    const MonotonicTime linked = fleet.now.mono;
    REQUIRE(ant.core->table().link(ant.link_to("bee"))->dialled);
    const auto dialled_at = [&](MonotonicTime time) {
      Effects effects;
      ant.core->tick({time, fleet.now.utc}, effects);
      return std::any_of(effects.list.begin(), effects.list.end(),
                         [](const Effect& effect) { return std::holds_alternative<DialLane>(effect); });
    };
    CHECK_FALSE(dialled_at(linked + kLaneAfter - Duration(1)));
    CHECK(dialled_at(linked + kLaneAfter) == lane);
  }
}

TEST_CASE("a lane was heard for long if it was for more than a lease") {
  for (const Duration more : {Duration{}, Duration(1)}) {
    Stream stream;
    RouterCore& bee = *stream.bee.core;
    const LinkId link = stream.bee.link_to("ant");
    const auto ends = [&](Duration after) {
      Effects effects;
      bee.lanes().on_ended(link, LinkEndReason::disconnected, {stream.fleet.now.mono + after, stream.fleet.now.utc},
                           effects);
      return *bee.lanes().of(link).dial_at - stream.fleet.now.mono - after;
    };
    CHECK(ends({}) == kLaneFirst);
    bee.lanes().on_connected(link, stream.fleet.now);
    CHECK(ends(Seconds(10) + more) == (more == Duration{} ? 2 * kLaneFirst : kLaneFirst));
  }
}
