// Sensors of a node's PC: sent to the fleet beside the robot's own, requested by name, gone with their service.
#include <doctest/doctest.h>

#include "services/router/test/test_pair.hpp"

using namespace trb;
using namespace trb::router;

namespace {

constexpr ConnectionId kAdapter = 1;
constexpr ConnectionId kSensors = 2;
constexpr ConnectionId kTrb = 3;

SensorInfo sensor(const std::string& name, const std::string& kind) {
  SensorInfo info;
  info.name = name;
  info.kind = kind;
  info.state = SensorState::ok;
  return info;
}

/// Ant has a mode-adapter and a sensor-bus.
struct Hall : LinkedPair {
  Hall() {
    hello(kAdapter, "mode-adapter");
    hello(kSensors, "sensor-bus", {"sensor_read"});
  }
  template <class T>
  void say(ConnectionId from, const T& body) {
    Effects effects;
    ant.core->forwarding().on_bus_message(from, make_message(MessageType::information, "ant", "ant", body), fleet.now,
                                          effects);
    fleet.carry_out(ant, effects);
  }
  void plug(std::vector<SensorInfo> sensors) {
    say(kSensors, NodeSensors{std::move(sensors)});
    fleet.run(kStep * 2);
  }
  void gone(ConnectionId from) {
    Effects effects;
    ant.core->on_connection_gone(from, fleet.now, effects);
    fleet.carry_out(ant, effects);
  }
  /// ant's profile as bee knows it.
  [[nodiscard]] const NodeProfile& profile() const { return bee.peer("ant")->profile; }
  [[nodiscard]] bool bee_knows_none() const { return profile().plugged.empty() && profile().sensors.empty(); }
  /// Where ant's router sends a message from bee.
  Routing come(const std::string& subtype, MessageType type) {
    const LinkId link = ant.link_to("bee");
    const Message message{.type = type, .subtype = subtype, .source = "bee", .target = "ant", .id = 9, .data = {}};
    return fleet.arrive(ant, link, ant.core->table().link(link)->heard + 1, message);
  }
  /// The sensor-bus sends signs of life for this time.
  void live(Duration time) {
    for (const MonotonicTime end = fleet.now.mono + time; fleet.now.mono < end; fleet.run(Seconds(1)))
      say(kSensors, ServiceAlive{100});
  }
};

using Words = std::vector<std::string>;

}  // namespace

TEST_CASE("a sensor that is plugged in is told to every peer at once, beside what the robot has") {
  Hall hall;
  NodeProfile robot;
  robot.model = "UR3";
  robot.capabilities = {"grab", "temperature"};
  robot.sensors = {"joints"};
  hall.say(kAdapter, robot);
  hall.plug({sensor("temp", "temperature"), sensor("temp_2", "temperature"), sensor("gps", "position")});
  CHECK(hall.profile().model == "UR3");
  CHECK(hall.profile().plugged.size() == 3);
  CHECK(hall.profile().sensors == Words{"joints", "temp", "temp_2", "gps"});
  CHECK(hall.profile().capabilities == Words{"grab", "temperature", "position"});

  // The robot's side changes, the sensors stay; a sensor goes, the robot stays.
  robot.robot = "OFFLINE";
  hall.say(kAdapter, robot);
  hall.plug({sensor("gps", "position")});
  CHECK(hall.profile().robot == "OFFLINE");
  CHECK(hall.profile().sensors == Words{"joints", "gps"});
  CHECK(hall.profile().capabilities == Words{"grab", "temperature", "position"});
}

TEST_CASE("each change is told once, what is no change not at all") {
  Hall hall;
  std::size_t told = 0;
  hall.fleet.meddle = [&](const std::string& from, LinkId, std::uint64_t&, Message& message) {
    told += from == "ant" && message.subtype == NodeProfile::kSubtype ? 1 : 0;
    return true;
  };
  hall.plug({sensor("temp", "temperature")});
  hall.plug({sensor("temp", "temperature")});
  CHECK(told == 1);
  SensorInfo silent = sensor("temp", "temperature");
  silent.state = SensorState::silent;
  hall.plug({silent});
  CHECK(told == 2);
}

TEST_CASE("a node without a robot may have sensors; a peer that comes later learns of all 255") {
  Hall hall;
  std::vector<SensorInfo> many;
  for (int i = 0; i < 255; ++i)
    many.push_back(sensor("s" + std::to_string(i), i < 100 ? "kind" + std::to_string(i) : "temperature"));
  hall.plug(many);
  CHECK(hall.profile().plugged.size() == 255);
  CHECK(hall.profile().sensors.size() == 255);
  CHECK(hall.profile().capabilities.size() == 64);
  hall.fleet.start("cat");
  hall.fleet.run(Seconds(3));
  const Peer* ant = hall.fleet.at("cat").peer("ant");
  REQUIRE(ant != nullptr);
  CHECK(ant->profile.plugged.size() == 255);  // it was too large for the Hello, and followed it
  CHECK(hall.ant.core->answers().route_table(hall.fleet.now).routes.at(0).profile.plugged.size() == 255);
}

TEST_CASE("only the sensor-bus tells of sensors, and the mode-adapter of none that are plugged") {
  Hall hall;
  hall.hello(kTrb, "sensor-bus", {}, true);
  hall.say(kTrb, NodeSensors{{sensor("forged", "temperature")}});
  hall.say(kAdapter, NodeSensors{{sensor("forged", "temperature")}});
  NodeProfile robot;
  robot.plugged = {sensor("forged", "temperature")};
  hall.say(kAdapter, robot);
  hall.fleet.run(kStep * 2);
  CHECK(hall.bee_knows_none());
}

TEST_CASE("a request for a plugged sensor goes to the sensor-bus, everything else of that name to the robot") {
  Hall hall;
  CHECK(hall.come("temp", MessageType::request).connection == kAdapter);
  hall.plug({sensor("temp", "temperature")});
  CHECK(hall.come("temp", MessageType::request).connection == kSensors);
  CHECK(hall.come("temp", MessageType::command).connection == kAdapter);
  CHECK(hall.come("temp", MessageType::information).connection == kAdapter);
  CHECK(hall.come("temperature", MessageType::request).connection == kAdapter);
  hall.plug({});
  CHECK(hall.come("temp", MessageType::request).connection == kAdapter);
}

TEST_CASE("a sensor named like a word of the middleware takes nothing from it") {
  Hall hall;
  hall.plug({sensor("run_query", "temperature"), sensor("sensor_read", "temperature")});
  CHECK(hall.come("run_query", MessageType::request).reason == Errc::no_service);
  CHECK(hall.come("sensor_read", MessageType::request).connection == kSensors);
}

TEST_CASE("a sensor-bus that comes back in time keeps its sensors, one that does not takes them along") {
  Hall hall;
  hall.plug({sensor("temp", "temperature")});
  hall.gone(kSensors);
  CHECK(hall.come("temp", MessageType::request).reason == Errc::no_service);  // not the robot's, even now
  hall.fleet.run(Seconds(1));
  CHECK(hall.profile().plugged.size() == 1);
  hall.hello(kSensors, "sensor-bus");
  hall.plug({sensor("temp", "temperature")});
  hall.live(Seconds(5));
  CHECK(hall.profile().plugged.size() == 1);

  hall.gone(kSensors);
  hall.fleet.run(Seconds(4));
  CHECK(hall.bee_knows_none());
}

TEST_CASE("a sensor-bus that hangs takes its sensors along after a lease") {
  Hall hall;
  hall.plug({sensor("temp", "temperature")});
  hall.live(Seconds(20));
  CHECK(hall.profile().plugged.size() == 1);
  hall.fleet.run(Seconds(12));
  CHECK(hall.bee_knows_none());
}

TEST_CASE("a robot's own sensors and what is plugged in are 255 together; that some are not among them is told once") {
  Hall hall;
  const auto warned = [&] {
    return std::count_if(hall.ant.log.begin(), hall.ant.log.end(),
                         [](const std::string& line) { return line.starts_with("too_many_sensors"); });
  };
  NodeProfile robot;
  robot.sensors = {"joints"};
  hall.say(kAdapter, robot);
  std::vector<SensorInfo> many;
  for (int i = 0; i < 254; ++i) many.push_back(sensor("s" + std::to_string(i), ""));
  hall.plug(many);
  CHECK(hall.profile().sensors.size() == 255);
  CHECK(hall.profile().capabilities.empty());
  CHECK(warned() == 0);
  many.push_back(sensor("s254", ""));
  hall.plug(many);
  CHECK(hall.profile().sensors.size() == 255);
  CHECK(hall.profile().plugged.size() == 255);
  CHECK(warned() == 1);
}

TEST_CASE("a robot that fills its profile is told whole; what is plugged in gives way, and how much of it is counted") {
  Hall hall;
  NodeProfile robot;
  robot.places.assign(250, std::string(250, 'p'));
  hall.say(kAdapter, robot);
  hall.fleet.run(kStep * 2);
  REQUIRE(hall.profile().places.size() == 250);
  std::vector<SensorInfo> few = {sensor("t", "temperature")};
  hall.plug(few);
  CHECK(hall.profile().plugged.size() == 1);
  CHECK(hall.ant.count("dropped.profile_details") == 0);
  std::vector<SensorInfo> many;
  for (int i = 0; i < 250; ++i) many.push_back(sensor("s" + std::to_string(i), ""));
  hall.plug(many);
  CHECK(hall.profile().plugged.empty());
  CHECK(hall.profile().sensors.size() == 250);
  CHECK(hall.profile().places == robot.places);
  CHECK(hall.ant.count("dropped.profile_details") == 1);
  for (SensorInfo& one : many) one.name = std::string(50, 'n') + one.name;
  hall.plug(many);
  CHECK(hall.profile() == robot);
  // What a mode-adapter sends about plugged sensors is ignored: it does not make the profile too large.
  robot.model = "UR5";
  NodeProfile forged = robot;
  forged.plugged = many;
  hall.say(kAdapter, forged);
  hall.fleet.run(kStep * 2);
  CHECK(hall.profile() == robot);
  CHECK(hall.ant.count("refused.profile_too_large") == 0);
}

TEST_CASE("sensors go three seconds after their service's connection, and with nobody else's") {
  Hall hall;
  hall.plug({sensor("temp", "temperature")});
  hall.hello(kTrb, "sensor-bus", {}, true);
  hall.gone(kTrb);
  hall.gone(kAdapter);
  hall.live(Seconds(5));
  CHECK(hall.profile().plugged.size() == 1);
  hall.gone(kSensors);
  hall.fleet.run(Seconds(3) - kStep);
  CHECK(hall.ant.core->answers().route_table(hall.fleet.now).routes.at(0).profile.plugged.size() == 1);
  hall.fleet.run(kStep);
  CHECK(hall.ant.core->answers().route_table(hall.fleet.now).routes.at(0).profile.plugged.empty());
}
