// A received profile is bounded, so that whatever contains many of them can be sent.
#include <doctest/doctest.h>

#include "common/actor/route_pages.hpp"
#include "services/router/test/test_fleet.hpp"

using namespace trb;
using namespace trb::router;

namespace {

/// A profile of about this size.
NodeProfile large(std::size_t bytes) {
  NodeProfile profile;
  profile.maker = "test";
  while (bytes > 300) {
    SkillInfo skill;
    skill.name = "skill" + std::to_string(profile.skills.size());
    for (int i = 0; i < 32 && bytes > 300; ++i, bytes -= 257 * 4) {
      ParameterInfo parameter;
      parameter.one_of.assign(4, std::string(250, 'x'));
      skill.parameters.push_back(parameter);
      if (bytes < 257 * 4 + 300) break;
    }
    profile.skills.push_back(skill);
    if (bytes < 257 * 4 + 300) break;
  }
  return profile;
}

struct ProfilePair {
  TestFleet fleet;
  TestNode& ant = fleet.start("ant");
  TestNode& bee = fleet.start("bee");

  ProfilePair() { fleet.run(Seconds(1)); }
  void tell(const Bytes& profile) {
    fleet.say("bee", "ant", std::string(NodeProfile::kSubtype), profile);
    fleet.run(2 * kStep);
  }
  LinkErrorTable errors() {
    Message asked = make_message(MessageType::request, "ant", "ant", LinkErrorTableRequest{});
    serve("scheduler", 9);
    Effects effects;
    ant.core->forwarding().on_bus_message(9, asked, fleet.now, effects);
    return *decode<LinkErrorTable>(std::get<BusSend>(effects.list.at(0)).message.data);
  }
  void serve(const std::string& service, ConnectionId from) { serve(ant, service, from); }
  void serve(TestNode& node, const std::string& service, ConnectionId from) {
    Effects effects;
    node.core->bus().on_hello(from, {service, {}, 5, 100, "1"}, service, fleet.now, effects);
    fleet.carry_out(node, effects);
  }
  void own(ConnectionId from, const Body& body) { own(ant, from, body); }
  /// This node's mode-adapter reports its robot.
  void own_robot(TestNode& node) {
    NodeProfile robot;
    robot.robot = "ONLINE";
    serve(node, "mode-adapter", 2);
    own(node, 2, robot);
  }
  void own_robot() { own_robot(ant); }
  void own(TestNode& node, ConnectionId from, const Body& body) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype_of(body);
    message.data = encode_body(body);
    Effects effects;
    node.core->forwarding().on_bus_message(from, message, fleet.now, effects);
    fleet.carry_out(node, effects);
    fleet.run(2 * kStep);
  }
};

}  // namespace

TEST_CASE("a peer's profile over 64 KiB is refused: the one before stands, and so does the link") {
  ProfilePair pair;
  const LinkId link = pair.ant.link_to("bee");
  pair.tell(encode(large(60'000)));
  const NodeProfile before = pair.ant.peer("bee")->profile;
  CHECK(encode(before).size() > 50'000);
  NodeProfile far_too_large;
  far_too_large.maker = "evil";
  far_too_large.places.assign(255, std::string(255, 'x'));
  far_too_large.sensors.assign(255, std::string(255, 'y'));
  pair.tell(encode(far_too_large));
  CHECK(pair.ant.count("refused.profile_too_large") == 1);
  CHECK(pair.ant.peer("bee")->profile == before);
  CHECK(pair.ant.link_to("bee") == link);
  const LinkErrorTable errors = pair.errors();
  REQUIRE(errors.errors.size() == 1);
  CHECK(errors.errors[0].peer == "bee");
  CHECK(errors.errors[0].code == "profile_too_large");
}

TEST_CASE("a profile that is small on the wire and grows as it is read is measured as it is kept") {
  ProfilePair pair;
  // 128 skills of 32 parameters, each an empty array: one byte as received, eight when encoded again.
  Bytes data("\x9f\xa0\xa0\xa0\xa0\xa0\x90\x90\xdc\x00\x80", 11);
  for (int skill = 0; skill < 128; ++skill) {
    data += Bytes("\x93\xa0\xa0\xdc\x00\x20", 6);
    for (int parameter = 0; parameter < 32; ++parameter) data += Bytes("\x95\xa0\xa0\xc3\xa0\x92\x01\x02", 8);
  }
  data += Bytes("\x90\xa0\xa0\xc2\xa0\x90\x90", 7);
  REQUIRE(decode<NodeProfile>(data).ok());
  CHECK(data.size() < kMaxProfileSize);
  CHECK(encode(*decode<NodeProfile>(data)).size() > kMaxProfileSize);
  pair.tell(data);
  CHECK(pair.ant.count("refused.profile_too_large") == 1);
}

TEST_CASE("the node's own profile that no peer would take is not told, and doctor says why") {
  ProfilePair pair;
  pair.serve("mode-adapter", 1);
  NodeProfile profile = large(20'000);
  pair.own(1, profile);
  CHECK(pair.bee.peer("ant")->profile == profile);
  pair.own(1, large(70'000));
  CHECK(pair.ant.count("refused.profile_too_large") == 1);
  CHECK(pair.bee.peer("ant")->profile == profile);
  CHECK(pair.bee.count("refused.profile_too_large") == 0);
  const LinkErrorTable errors = pair.errors();
  REQUIRE(errors.errors.size() == 1);
  CHECK(errors.errors[0].peer == "ant");
}

TEST_CASE("what is out of use is told whole, and where there is no room for the words, without them") {
  ProfilePair pair;
  pair.serve("mode-adapter", 1);
  NodeProfile profile = large(20'000);
  for (int i = 0; i < 60; ++i) {
    profile.out_of_use.push_back({"c" + std::to_string(i), Severity::critical, std::string(255, 'w'), 7, false, "ann"});
  }
  profile.numbers = {{"payload", 3, "kg"}};
  pair.own(1, profile);
  CHECK(pair.bee.peer("ant")->profile == profile);
  profile.skills = large(55'000).skills;
  pair.own(1, profile);
  const auto& told = pair.bee.peer("ant")->profile;
  CHECK(told.skills == profile.skills);
  REQUIRE(told.out_of_use.size() == 60);
  CHECK(told.out_of_use[59].capability == "c59");
  CHECK(told.out_of_use[59].text.empty());
}

TEST_CASE("of too much that is plugged in the details go first, then the sensors, never the robot") {
  ProfilePair pair;
  pair.serve("mode-adapter", 1);
  pair.serve("sensor-bus", 2);
  NodeProfile robot = large(30'000);
  pair.own(1, robot);
  const auto plug = [&](int count, std::size_t detail) {
    NodeSensors sensors;
    for (int i = 0; i < count; ++i) {
      SensorInfo info;
      info.name = "t" + std::to_string(i);
      info.kind = "temperature";
      info.device = std::string(detail / 2, 'd');
      info.detail = std::string(detail, 'e');
      sensors.sensors.push_back(info);
    }
    pair.own(2, sensors);
    const auto& peer = pair.bee.peer("ant")->profile;
    CHECK(peer.skills == robot.skills);
    CHECK(encode(peer).size() <= kMaxProfileSize);
    return peer;
  };
  CHECK(plug(10, 250).plugged.at(3).detail.size() == 250);
  CHECK(pair.ant.count("dropped.profile_details") == 0);
  const NodeProfile cut = plug(200, 250);
  CHECK(cut.plugged.size() == 200);
  CHECK(cut.plugged[3].detail.empty());
  CHECK(cut.plugged[3].device.size() == 125);
  CHECK(pair.ant.count("dropped.profile_details") == 1);
  CHECK(plug(255, 255).plugged.at(3).device.empty());
  CHECK(pair.bee.count("refused.profile_too_large") == 0);
}

TEST_CASE("a Hello over 4 kB is nobody's, a member's neither: its profile follows when the link is up") {
  ProfilePair pair;
  TestNode& cat = pair.fleet.start("cat");
  pair.fleet.run(Seconds(2));
  REQUIRE(pair.ant.link_to("cat") != 0);
  Message hello =
      make_message(MessageType::information, "cat", "ant",
                   Hello{cat.keys.record, 9, "cat", "1", kStartUtc, true, large(5'000), 0, "behind", false, ""});
  Effects effects;
  pair.ant.core->inbox().on_message(1234, cat.keys.link.public_key, hello, 1, pair.fleet.now, effects);
  pair.fleet.carry_out(pair.ant, effects);
  CHECK(pair.ant.count("refused.too_large") == 1);
  CHECK(pair.ant.link_to("bee") != 0);
}

TEST_CASE("a table of many large profiles comes in pages, each of which its reader takes") {
  TestFleet fleet;
  TestNode& zed = fleet.start("zed");
  for (const char* name : {"n1", "n2", "n3", "n4", "n5", "n6", "n7", "n8", "n9"}) fleet.start(name);
  fleet.run(Seconds(3));
  for (const char* name : {"n1", "n2", "n3", "n4", "n5", "n6", "n7", "n8", "n9"})
    fleet.say(name, "zed", std::string(NodeProfile::kSubtype), encode(large(62'000)));
  fleet.run(2 * kStep);
  RoutePages pages;
  RouteListRequest question;
  std::optional<RouteTable> whole;
  int asked = 0;
  for (; !whole && asked < 20; ++asked) {
    const RouteTable page = zed.core->answers().route_table(fleet.now, question.after);
    const auto packed = pack(page);
    REQUIRE(packed.ok());
    CHECK(packed->size() <= 256U << 10U);
    auto taken = pages.take(*decode<RouteTable>(*packed));
    whole = std::move(taken.whole);
    if (taken.next) question = *taken.next;
  }
  REQUIRE(whole);
  CHECK(asked == 3);
  REQUIRE(whole->routes.size() == 10);
  CHECK(whole->routes[0].state == "self");
  CHECK(whole->routes[9].id == "n9");
  CHECK(whole->routes[9].profile.maker == "test");
}

TEST_CASE("what a hearer would have to refuse is not sent; who waits for it is told") {
  ProfilePair pair;
  RouterConfig config;  // more services than the table has rows
  config.id = "many";
  for (int i = 0; i < 40; ++i) config.services.push_back("s" + std::to_string(i));
  RouterCore core(config);
  Effects effects;
  core.bus().on_hello(1, {"s1", {}, 5, 100, "1"}, "s1", pair.fleet.now, effects);
  effects = {};
  Message asked = make_message(MessageType::request, "many", "many", ServiceListRequest{});
  core.forwarding().on_bus_message(1, asked, pair.fleet.now, effects);
  const auto& sends = effects.list;
  const auto* nack = std::get_if<BusSend>(&sends.back());
  REQUIRE(nack != nullptr);
  CHECK(nack->message.subtype == Nack::kSubtype);
  CHECK(nack->message.reply_to == asked.id);
  CHECK(decode<Nack>(nack->message.data)->code == "too_large");
  CHECK(decode<Nack>(nack->message.data)->what == "service_table: services: list over 32 items");
  CHECK(effects.counts.back() == "dropped.too_large");
}

TEST_CASE("a profile fits to the byte") {
  NodeProfile profile;
  profile.places.assign(254, std::string(255, 'p'));
  const auto size = [&] { return encode(profile).size(); };
  REQUIRE(size() < kMaxProfileSize);
  while (kMaxProfileSize - size() > 500) profile.sensors.emplace_back(255, 's');
  profile.maker = std::string(40, 'm');
  while (size() < kMaxProfileSize) {
    std::string& last = profile.maker.size() < 120 ? profile.maker : profile.sensors.emplace_back();
    last += 'x';
  }
  REQUIRE(size() >= kMaxProfileSize);
  CHECK(fits(profile) == (size() == kMaxProfileSize));
  NodeProfile more = profile;
  more.model += "xx";  // not the maker: a text over its own bound is cut
  CHECK_FALSE(fits(more));
}

TEST_CASE("a router gathers the fleet for three seconds, and for ten while its robot or a member is awaited") {
  ProfilePair pair;
  const auto gathers = [&] { return pair.ant.core->answers().route_table(pair.fleet.now).gathers; };
  CHECK(gathers());
  SUBCASE("its robot has not reported") {
    pair.fleet.run(Seconds(8));
    CHECK(gathers());
    pair.fleet.run(Seconds(2));
    CHECK_FALSE(gathers());
  }
  SUBCASE("all are there") {
    pair.own_robot();
    CHECK(gathers());
    pair.fleet.run(Seconds(3));
    CHECK_FALSE(gathers());
  }
}

TEST_CASE("a router that was linked to a member in the run before awaits it for ten seconds") {
  ProfilePair pair;
  pair.fleet.stop("ant");
  pair.fleet.stop("bee");
  TestNode& ant = pair.fleet.start("ant", {.boot = 2, .known = {"bee"}});
  pair.own_robot(ant);
  const auto gathers = [&] { return ant.core->answers().route_table(pair.fleet.now).gathers; };
  pair.fleet.run(Seconds(5));
  CHECK(gathers());
  SUBCASE("it comes") {
    pair.fleet.start("bee", {.boot = 2});
    pair.fleet.run(Seconds(4));
    CHECK_FALSE(gathers());
  }
  SUBCASE("it does not") {
    pair.fleet.run(Seconds(6));
    CHECK_FALSE(gathers());
  }
}
