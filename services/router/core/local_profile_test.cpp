// The local profile by itself: what peers receive when the robot or a sensor changes.
#include "services/router/core/local_profile.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Own : Parts {
  LocalProfile profile{node, table, messages, errors};
  Link& link = link_with(bee);

  [[nodiscard]] Duration silent() const { return node.config().timing.service_silent; }
  void tell_robot(const std::string& robot) {
    out = {};
    NodeProfile told;
    told.robot = robot;
    told.fenced = true;
    profile.on_robot(told, now, out);
  }
  void plug(const std::string& name) {
    out = {};
    SensorInfo sensor;
    sensor.name = name;
    sensor.kind = "camera";
    profile.on_sensors({{sensor}}, out);
  }
};

}  // namespace

TEST_CASE("given a sensor that is plugged in, then every peer is sent the new profile, once") {
  Own own;
  own.plug("eye");
  REQUIRE(own.all<LinkSend>().size() == 1);
  const auto sent = decode<NodeProfile>(own.all<LinkSend>()[0].message.data);
  CHECK(sent->sensors == std::vector<std::string>{"eye"});
  CHECK(sent->capabilities == std::vector<std::string>{"camera"});
  CHECK(own.profile.is_plugged("eye"));
  own.plug("eye");
  CHECK(own.all<LinkSend>().empty());
  own.profile.send(own.link, own.out);
  CHECK(own.all<LinkSend>().empty());
}

TEST_CASE("given a sensor-bus that is gone, then its sensors are given up after three seconds, not before") {
  Own own;
  own.plug("eye");
  own.profile.on_service_gone(kSensorBus, own.now);
  own.pass(own.silent() - Duration(1));
  own.profile.tick({}, own.now, own.out);
  CHECK(own.profile.is_plugged("eye"));
  own.pass(Duration(1));
  own.profile.tick({}, own.now, own.out);
  CHECK_FALSE(own.profile.is_plugged("eye"));
  CHECK(own.profile.profile().plugged.empty());
  CHECK_FALSE(own.profile.next_deadline({}));
}

TEST_CASE("given a sensor-bus that hangs, then its sensors are away after a lease, and back once it is heard") {
  Own own;
  own.plug("eye");
  const ReportersHeard heard{own.now.mono, {}};
  own.pass(own.node.config().timing.lease);
  own.profile.tick(heard, own.now, own.out);
  CHECK_FALSE(own.profile.is_plugged("eye"));
  CHECK(own.profile.profile().plugged.empty());
  own.profile.tick({own.now.mono, {}}, own.now, own.out);
  CHECK(own.profile.is_plugged("eye"));
  CHECK(own.profile.profile().plugged.size() == 1);
}

TEST_CASE("given a mode-adapter that is gone for three seconds, then its robot is not called ONLINE any more") {
  Own own;
  own.tell_robot("ONLINE");
  own.profile.on_service_gone(kModeAdapter, own.now);
  own.out = {};
  own.pass(own.silent() - Duration(1));
  own.profile.tick({}, own.now, own.out);
  CHECK(own.all<LinkSend>().empty());
  REQUIRE(own.profile.next_deadline({}) == own.now.mono + Duration(1));
  own.pass(Duration(1));
  own.profile.tick({}, own.now, own.out);
  REQUIRE(own.all<LinkSend>().size() == 1);
  const auto sent = decode<NodeProfile>(own.all<LinkSend>()[0].message.data);
  CHECK(sent->robot == "CONNECTION_BROKEN");
  CHECK(sent->detail.find("mode-adapter") != std::string::npos);
  CHECK(sent->fenced);
  CHECK_FALSE(own.profile.next_deadline({}));
  own.tell_robot("ONLINE");
  CHECK(own.profile.profile().robot == "ONLINE");
  CHECK(own.profile.profile().detail.empty());
}

TEST_CASE("given a mode-adapter that comes back in time, or a node without a robot, then no peer is told a thing") {
  Own own;
  own.tell_robot("");
  own.profile.on_service_gone(kModeAdapter, own.now);
  CHECK_FALSE(own.profile.next_deadline({}));
  own.tell_robot("ONLINE");
  own.profile.on_service_gone(kModeAdapter, own.now);
  own.pass(own.silent() / 2);
  own.tell_robot("ONLINE");
  CHECK(own.all<LinkSend>().empty());
  own.pass(own.silent());
  own.profile.tick({}, own.now, own.out);
  CHECK(own.all<LinkSend>().empty());
  CHECK(own.profile.profile().robot == "ONLINE");
}

TEST_CASE("given a robot's profile with no room for why the robot is not there, then it is refused") {
  Own own;
  NodeProfile told;
  told.robot = "ONLINE";
  told.sensors.assign(150, std::string(200, 's'));
  const auto room = [&] { return kMaxProfileSize - encode(told).size(); };
  while (room() > 400) told.places.push_back(std::string(200, 'x'));
  told.places.push_back(std::string(room() - 50, 'x'));
  REQUIRE(fits(told));
  own.profile.on_robot(told, own.now, own.out);
  CHECK(own.counted("refused.profile_too_large") == 1);
  told.places.pop_back();
  own.profile.on_robot(told, own.now, own.out);
  own.profile.on_service_gone(kModeAdapter, own.now);
  own.pass(own.silent());
  own.profile.tick({}, own.now, own.out);
  CHECK(own.profile.profile().robot == "CONNECTION_BROKEN");
  CHECK(fits(own.profile.profile()));
}

TEST_CASE("given a robot's profile that no peer would take, then the one before stands, and it is a link error") {
  Own own;
  NodeProfile large;
  for (int i = 0; i < 2000; ++i)
    large.skills.push_back({"skill_" + std::to_string(i), std::string(60, 'x'), {}, false, 5});
  own.profile.on_robot(large, own.now, own.out);
  CHECK(own.profile.profile().skills.empty());
  CHECK(own.counted("refused.profile_too_large") == 1);
  CHECK(own.errors.table("ant", own.now.mono).errors.size() == 1);
}
