// The fleet view with messages in order, late, repeated, from the wrong node and too many.
#include <doctest/doctest.h>

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

RobotState large_state(char fill) {
  RobotState out;
  for (int i = 0; i < 32; ++i) out.values.push_back({"value" + std::to_string(i), std::string(1000, fill)});
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

TEST_CASE("a sensor is unplugged: it and its value are gone") {
  Hall hall;
  hall.table({with_sensor("pioneer1")});
  hall.watch("pioneer1", "dht22");
  hall.say("pioneer1", reading(21, 1));
  hall.table({route("pioneer1")});
  CHECK(hall.row(RowKind::sensor, "pioneer1", "dht22") == nullptr);
  CHECK(hall.row(RowKind::reading, "pioneer1", "dht22") == nullptr);
}

TEST_CASE("runs: an older word of one is ignored; the table alone may go back") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 5)}});
  hall.say("cloud", RunChanged{run(RunState::paused, 6)});
  hall.say("cloud", RunChanged{run(RunState::running, 4)});
  const Row* row = hall.row(RowKind::run, "", kRun);
  CHECK(std::get<RunSummary>(row->content).state == RunState::paused);
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  CHECK(std::get<RunSummary>(row->content).state == RunState::running);
}

TEST_CASE("time that runs down makes no new version of a run") {
  Hall hall;
  RunSummary one = run(RunState::running, 1);
  one.left_s = 60;
  hall.say("cloud", RunTable{{one}});
  one.left_s = 55;
  hall.say("cloud", RunTable{{one}});
  CHECK(hall.row(RowKind::run, "", kRun)->version == 1);
}

TEST_CASE("a run leaves the table without a word of its end: it does not look live, and is asked for") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  hall.say("cloud", RunTable{});
  CHECK(hall.live(RowKind::run, "", kRun) == Live::not_heard);
  hall.wait(seconds(0.1));
  REQUIRE(sent<RunQuery>(hall.out).size() == 1);
  RunView view;
  view.run = kRun;
  view.state = RunState::finished;
  hall.say("cloud", view);
  const Row* row = hall.row(RowKind::run, "", kRun);
  CHECK(row->live == Live::live);
  CHECK(std::get<RunSummary>(row->content).state == RunState::finished);
  hall.say("cloud", RunTable{});
  CHECK(row->live == Live::live);
}

TEST_CASE("a run that the scheduler knows nothing of, asked five times, is shown no longer") {
  Hall hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  hall.say("cloud", RunTable{});
  for (int i = 0; i < 7; ++i) hall.wait(seconds(2));
  CHECK(sent<RunQuery>(hall.out).size() == 5);
  CHECK(hall.row(RowKind::run, "", kRun) == nullptr);
}

TEST_CASE("a run that somebody looks at is asked for, and again at each change") {
  Hall hall;
  hall.view.watch_runs({kRun}, hall.now);
  hall.wait({});
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  RunView view;
  view.run = kRun;
  hall.say("cloud", view);
  hall.wait(seconds(5));
  CHECK(sent<RunQuery>(hall.out).size() == 1);
  hall.say("cloud", RunChanged{run(RunState::paused, 2)});
  hall.wait({});
  CHECK(sent<RunQuery>(hall.out).size() == 2);
}

TEST_CASE("an alert that is in no table any more is gone; silence makes all of them not heard") {
  Hall hall;
  hall.say("cloud", AlertTable{{alert("a1", "pioneer1"), alert("a2", "pioneer2")}});
  hall.say("cloud", AlertTable{{alert("a2", "pioneer2")}});
  CHECK(hall.row(RowKind::alert, "", "a1") == nullptr);
  hall.wait(seconds(10));
  CHECK(hall.live(RowKind::alert, "", "a2") == Live::not_heard);
}

TEST_CASE("a service of the own node is silent until its first table, which may be empty, and when it has been quiet") {
  Hall hall;
  hall.wait({});
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::scheduler, RowSource::resilience});
  hall.table({route("pioneer1")});
  hall.say("pioneer1", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::scheduler, RowSource::resilience});
  hall.say("cloud", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::scheduler});
  hall.say("cloud", RunTable{});
  CHECK(hall.view.silent().empty());
  hall.wait(FleetView::kAlertsSilence);
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::resilience});
  hall.say("cloud", AlertTable{});
  CHECK(hall.view.silent() == RowSources{RowSource::router});
  hall.wait(FleetView::kRunsSilence - FleetView::kAlertsSilence);
  CHECK(hall.view.silent() == RowSources{RowSource::router, RowSource::scheduler});
}

TEST_CASE("a robot of too many values keeps 64 of them, and says so") {
  Hall hall;
  hall.table({route("pioneer1")});
  for (int i = 0; i < 100; ++i) hall.tell("pioneer1", "v" + std::to_string(i), "1");
  CHECK(hall.robot("pioneer1").values.size() == 64);
  CHECK(hall.robot("pioneer1").cut);
  for (int i = 0; i < 100; ++i) hall.say("pioneer1", RobotFault{"c" + std::to_string(i), Severity::warning, "", false});
  CHECK(hall.robot("pioneer1").faults.size() == 64);
}

TEST_CASE("a node over its budget is refused, shown as such, and others are taken") {
  Hall hall;
  Route greedy = route("greedy");
  for (int i = 0; i < 255; ++i) {
    SensorInfo sensor;
    sensor.name = "s" + std::to_string(i);
    sensor.detail = std::string(255, 'x');
    sensor.device = std::string(128, 'x');
    greedy.profile.plugged.push_back(sensor);
  }
  hall.table({greedy, route("pioneer1")});
  for (int i = 0; i < 64; ++i) hall.tell("greedy", "v" + std::to_string(i), std::string(1000, 'a'));
  CHECK(hall.counted("refused.node_budget") > 0);
  CHECK(hall.live(RowKind::robot, "greedy") == Live::refused);
  hall.say("cloud", PeerExpired{"greedy", "10 s unheard"});
  CHECK(hall.live(RowKind::robot, "greedy") == Live::not_heard);
  hall.table({greedy, route("pioneer1")});
  CHECK(hall.live(RowKind::robot, "greedy") == Live::refused);
  hall.tell("pioneer1", "battery", "80");
  CHECK(hall.live(RowKind::robot, "pioneer1") == Live::live);
}

TEST_CASE("a node that tells too much is told slowly, with its newest value; another one's word goes at once") {
  Hall hall;
  hall.table({route("greedy"), route("pioneer1")});
  const std::uint64_t before = hall.book.head();
  for (int i = 0; i < 100; ++i) hall.say("greedy", large_state(i % 2 == 0 ? 'a' : 'b'));
  CHECK(hall.book.head() - before <= 6);
  const std::uint64_t head = hall.book.head();
  hall.tell("pioneer1", "battery", "80");
  CHECK(hall.row(RowKind::robot, "pioneer1")->number == head + 1);
  hall.wait(seconds(3));
  CHECK(hall.row(RowKind::robot, "greedy")->number > head + 1);
  CHECK(hall.robot("greedy").values[0].value[0] == 'b');
}

TEST_CASE("no more than 2,000 nodes, and no node without an id") {
  Hall hall;
  for (int i = 0; i < 2100; ++i) hall.tell("robot" + std::to_string(i), "battery", "80");
  CHECK(hall.counted("refused.too_many_nodes") == 100);
  Hall other;
  other.table({route("No Id!")});
  CHECK(other.counted("dropped.no_id") == 1);
}
