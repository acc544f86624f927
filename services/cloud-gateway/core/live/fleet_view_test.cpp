// The fleet view with messages about nodes, robots and sensors: in order, late, repeated, from the wrong node.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

bool hears(std::string_view word) {
  const auto words = FleetView::subscriptions();
  return std::find(words.begin(), words.end(), word) != words.end();
}

Route with_sensor(const std::string& id) {
  Route out = route(id);
  SensorInfo sensor;
  sensor.name = "dht22";
  out.profile.plugged = {sensor};
  return out;
}

}  // namespace

TEST_CASE("it hears what robots and the router tell, and asks its own node for the rest") {
  CHECK(hears(RobotState::kSubtype));
  CHECK(hears(PeerExpired::kSubtype));
  CHECK_FALSE(hears(RunChanged::kSubtype));
  Hall hall;
  hall.wait({});
  CHECK(sent<RouteListRequest>(hall.out).size() == 1);
  CHECK(sent<RunWatch>(hall.out).size() == 1);
  CHECK(sent<AlertListRequest>(hall.out).size() == 1);
  hall.wait(seconds(2));
  CHECK(sent<RouteListRequest>(hall.out).size() == 2);
}

TEST_CASE("a robot tells its battery: its row has the value, the version rises, the time is when it was heard") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.tell("pioneer1", "battery", "80");
  const std::uint64_t version = hall.row(RowKind::robot, "pioneer1")->version;
  hall.wait(seconds(1));
  hall.tell("pioneer1", "battery", "79");
  const Row* row = hall.row(RowKind::robot, "pioneer1");
  CHECK(row->version == version + 1);
  CHECK(row->heard.mono == hall.now.mono);
  CHECK(row->live == Live::live);
  CHECK(hall.robot("pioneer1").values[0].value == "79");
}

TEST_CASE("the same word again is no new version, and is told for its age every 5 s") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.tell("pioneer1", "battery", "80");
  const Row before = *hall.row(RowKind::robot, "pioneer1");
  hall.wait(seconds(1));
  hall.tell("pioneer1", "battery", "80");
  const Row* row = hall.row(RowKind::robot, "pioneer1");
  CHECK(row->version == before.version);
  CHECK(row->number == before.number);
  CHECK(row->heard.mono == hall.now.mono);
  hall.wait(seconds(5));
  hall.tell("pioneer1", "battery", "80");
  CHECK(row->version == before.version);
  CHECK(row->number > before.number);
}

TEST_CASE("a node's lease runs out: nothing of it looks live, and a word that was under way does not change that") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.tell("pioneer1", "battery", "80");
  hall.watch("pioneer1", "dht22");
  hall.say("pioneer1", reading(21, 1));
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  for (const RowKind kind : {RowKind::node, RowKind::robot, RowKind::profile}) {
    CHECK(hall.live(kind, "pioneer1") == Live::not_heard);
  }
  CHECK(hall.live(RowKind::reading, "pioneer1", "dht22") == Live::not_heard);
  hall.tell("pioneer1", "battery", "79");
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::not_heard);
  CHECK(hall.robot("pioneer1").values[0].value == "79");
}

TEST_CASE("a node returns: it is live at once, its robot when somebody says what it is now") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.tell("pioneer1", "battery", "80");
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  hall.say("cloud", PeerJoined{"pioneer1", 8});
  CHECK(hall.live(RowKind::node, "pioneer1") == Live::live);
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::not_heard);
  hall.table({route("pioneer1")});
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::live);
}

TEST_CASE("a join of an earlier boot comes late: it is ignored") {
  Hall hall;
  hall.table({route("pioneer1", "OFFLINE")});
  hall.say("cloud", PeerJoined{"pioneer1", 6});
  CHECK(hall.live(RowKind::node, "pioneer1") == Live::not_heard);
}

TEST_CASE("a node's row says when its certificate ends, also after it was renewed") {
  Hall hall;
  const auto with_end = [](std::int64_t end) {
    Route out = route("pioneer1");
    Certificate certificate;
    certificate.not_after = end;
    out.certificate.payload.bytes = encode(certificate);
    return out;
  };
  const auto end = [&] { return std::get<NodeRow>(hall.row(RowKind::node, "pioneer1")->content).certificate_ends.ns; };
  hall.table({route("pioneer1")});
  CHECK(end() == 0);
  hall.table({with_end(1'800'000'000'000'000'000)});
  CHECK(end() == 1'800'000'000'000'000'000);
  const std::uint64_t version = hall.row(RowKind::node, "pioneer1")->version;
  hall.say("cloud", PeerJoined{"pioneer1", 8});
  CHECK(end() == 1'800'000'000'000'000'000);
  hall.table({with_end(1'900'000'000'000'000'000)});
  CHECK(end() == 1'900'000'000'000'000'000);
  CHECK(hall.row(RowKind::node, "pioneer1")->version > version);
}

TEST_CASE("a broken link is late, not gone") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.table({route("pioneer1", "CONNECTION_BROKEN")});
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::late);
}

TEST_CASE("the own router says nothing for 10 s: no node looks live until it does") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.wait(seconds(9.9));
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::live);
  hall.wait(seconds(0.2));
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::not_heard);
  CHECK(hall.live(RowKind::node, "cloud") == Live::not_heard);
  hall.table({route("pioneer1")});
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::live);
}

TEST_CASE("the fleet is known with the whole table, and not any more if the router is silent") {
  Hall hall;
  CHECK_FALSE(hall.view.knows_fleet());
  hall.wait({});
  CHECK_FALSE(hall.view.knows_fleet());
  hall.table({route("pioneer1")});
  CHECK(hall.view.knows_fleet());
  hall.wait(FleetView::kRoutesSilence);
  CHECK_FALSE(hall.view.knows_fleet());
}

TEST_CASE("a table made before the robot's own word does not undo it; a profile that has changed counts") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.say("pioneer1", RobotConnection{"OFFLINE", "cable"});
  hall.table({route("pioneer1")});
  CHECK(hall.robot("pioneer1").connection == "OFFLINE");
  Route fenced = route("pioneer1");
  fenced.profile.fenced = true;
  hall.table({fenced});
  CHECK(hall.robot("pioneer1").connection == "ONLINE");
  CHECK(hall.robot("pioneer1").fenced);
}

TEST_CASE("faults: one of each, their end takes them away, an end that comes first is nothing") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(hall.robot("pioneer1").faults.empty());
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "motor", false});
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "motor 2", false});
  REQUIRE(hall.robot("pioneer1").faults.size() == 1);
  CHECK(hall.robot("pioneer1").faults[0].text == "motor 2");
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "", true});
  CHECK(hall.robot("pioneer1").faults.empty());
}

TEST_CASE(
    "a lesser fault, whose end nobody tells, is shown for 15 minutes; one that keeps the robot out of use stays") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.say("pioneer1", RobotFault{"mobile", Severity::urgent, "battery low: 15 %", false});
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "motor", false});
  hall.wait(std::chrono::minutes(15));
  hall.table({route("pioneer1")});
  CHECK(hall.robot("pioneer1").faults.size() == 2);
  hall.wait(seconds(1));
  hall.table({route("pioneer1")});
  REQUIRE(hall.robot("pioneer1").faults.size() == 1);
  CHECK(hall.robot("pioneer1").faults[0].severity == Severity::critical);
}

TEST_CASE("a fault that the profile lists no more is over, though the robot's own word of it was lost") {
  Hall hall;
  Route broken = route("pioneer1");
  broken.profile.capabilities = {"mobile", "grab"};
  SUBCASE("of one capability") {
    broken.profile.out_of_use = {{"mobile", Severity::critical, "motor", 5, false, {}}};
  }
  SUBCASE("of the whole robot, which is told of each capability") {
    broken.profile.out_of_use = {{"", Severity::critical, "motor", 5, false, {}}};
    hall.say("pioneer1", RobotFault{"grab", Severity::critical, "motor", false});
  }
  hall.say("pioneer1", RobotFault{"mobile", Severity::critical, "motor", false});
  hall.say("pioneer1", RobotFault{"mobile", Severity::urgent, "battery low: 15 %", false});
  hall.table({broken});
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  Route begins = route("pioneer1");
  begins.profile = {};  // its node has just begun: it has told of no robot yet
  hall.table({begins});
  CHECK(hall.robot("pioneer1").out_of_use == broken.profile.out_of_use);
  broken.profile.out_of_use.clear();
  hall.table({broken});
  REQUIRE(hall.robot("pioneer1").faults.size() == 1);
  CHECK(hall.robot("pioneer1").faults[0].severity == Severity::urgent);
}

TEST_CASE("nobody else speaks for the own router, scheduler and resilience") {
  Hall hall;
  hall.table({route("pioneer1")});
  hall.say("pioneer1", RouteTable{"pioneer1", {route("ghost")}});
  hall.say("pioneer1", PeerExpired{"cloud", "no"});
  hall.say("pioneer1", RunTable{{run(RunState::running, 1)}});
  hall.say("pioneer1", AlertTable{{alert("a1", "pioneer1")}});
  hall.say("pioneer1", NodeSensors{});
  CHECK(hall.counted("dropped.foreign") == 5);
  CHECK(hall.row(RowKind::node, "ghost") == nullptr);
  CHECK(hall.live(RowKind::node, "cloud") == Live::live);
  CHECK(hall.row(RowKind::run, "", kRun) == nullptr);
  hall.say("pioneer1", Ack{"accepted", ""});
  CHECK(hall.counted("dropped.unexpected") == 1);
}

TEST_CASE("a node that is in no table any more is removed after 30 s, with all that is its own") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.wait(seconds(5));
  hall.table({});
  CHECK(hall.row(RowKind::node, "pioneer1") != nullptr);
  hall.wait(seconds(30));
  hall.table({});
  CHECK(hall.row(RowKind::node, "pioneer1") == nullptr);
  CHECK(hall.book.keys_of("pioneer1").empty());
}

TEST_CASE("a table of two pages is taken when it is whole") {
  Hall hall;
  hall.say("cloud", RouteTable{"cloud", {route("a1")}, true, ""});
  CHECK(sent<RouteListRequest>(hall.out).back().after == "a1");
  CHECK(hall.row(RowKind::node, "a1") == nullptr);
  hall.say("cloud", RouteTable{"cloud", {route("b1")}, false, "a1"});
  CHECK(hall.row(RowKind::node, "a1") != nullptr);
  CHECK(hall.row(RowKind::node, "b1") != nullptr);
}

TEST_CASE("readings: a late one is dropped, a repeated one confirms, silence of three periods makes it late") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.view.watch_sensors({{"pioneer1", "dht22"}, {"pioneer1", "made_up"}}, hall.now);
  hall.say("pioneer1", reading(21, 1));
  hall.wait(seconds(1));
  hall.say("pioneer1", reading(22, 3));
  hall.say("pioneer1", reading(21.5, 2));
  CHECK(hall.counted("dropped.late") == 1);
  const Row* row = hall.row(RowKind::reading, "pioneer1", "dht22");
  CHECK(std::get<SensorReading>(row->content).number == 22);
  hall.say("pioneer1", reading(22, 3));
  CHECK(row->version == 2);
  hall.wait(seconds(2.9));
  CHECK(row->live == Live::live);
  hall.wait(seconds(0.2));
  CHECK(row->live == Live::late);
  hall.say("pioneer1", reading(23, 4));
  CHECK(row->live == Live::live);
  SensorReading other = reading(1, 1);
  other.sensor = "made_up";
  hall.say("pioneer1", other);
  CHECK(hall.counted("dropped.unknown_sensor") == 1);
}

TEST_CASE("readings: a sensor-bus that counts from 1 again is shown again as soon as the last value is late") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.watch("pioneer1", "dht22");
  hall.say("pioneer1", reading(21, 3599));
  hall.wait(seconds(1));
  hall.say("pioneer1", reading(22, 3600));
  const Row* row = hall.row(RowKind::reading, "pioneer1", "dht22");
  for (std::uint64_t count = 1; count <= 3; ++count) {
    hall.wait(seconds(1));
    hall.say("pioneer1", reading(30, count));
  }
  CHECK(hall.counted("dropped.late") == 2);
  CHECK(row->live == Live::live);
  CHECK(std::get<SensorReading>(row->content).number == 30);
  hall.say("pioneer1", reading(29, 2));
  CHECK(hall.counted("dropped.late") == 3);
}

TEST_CASE("readings: a sensor-bus that counts from 1 again is shown at once if it has measured later") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.watch("pioneer1", "dht22");
  const auto measured = [](double number, std::uint64_t count, std::int64_t time) {
    SensorReading out = reading(number, count);
    out.time = time;
    return out;
  };
  hall.say("pioneer1", measured(21, 3600, 5'000));
  hall.say("pioneer1", measured(22, 1, 6'000));
  const Row* row = hall.row(RowKind::reading, "pioneer1", "dht22");
  CHECK(std::get<SensorReading>(row->content).number == 22);
  hall.say("pioneer1", measured(23, 2, 7'000));
  hall.say("pioneer1", measured(22, 1, 6'000));
  CHECK(hall.counted("dropped.late") == 1);
  CHECK(std::get<SensorReading>(row->content).number == 23);
}

TEST_CASE("readings: the count of a node that was away is forgotten, too") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.watch("pioneer1", "dht22");
  hall.say("pioneer1", reading(21, 3600));
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  hall.wait(seconds(4));
  hall.table({with_sensor("pioneer1")});
  hall.say("pioneer1", reading(22, 1));
  CHECK(hall.live(RowKind::reading, "pioneer1", "dht22") == Live::live);
  CHECK(hall.counted("dropped.late") == 0);
}

TEST_CASE("a sensor is unplugged: it and its value are gone") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.watch("pioneer1", "dht22");
  hall.say("pioneer1", reading(21, 1));
  hall.table({route("pioneer1")});
  CHECK(hall.row(RowKind::sensor, "pioneer1", "dht22") == nullptr);
  CHECK(hall.row(RowKind::reading, "pioneer1", "dht22") == nullptr);
}
