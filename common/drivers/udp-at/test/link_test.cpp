// The link to an AR.Drone: waking it, the repeated state, settings, and losses.
#include "common/drivers/udp-at/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

using Calls = std::vector<std::string>;

TEST_CASE("drone: it is woken, told to tell its flight data, and then counts as there") {
  Fixture fixture(drone());
  fixture.welcome();
  fixture.up(Channel::command);
  fixture.up(Channel::monitor);
  fixture.wait(0);
  CHECK(fixture.written(Channel::monitor) == std::string("\1\0\0\0", 4));
  fixture.wait(2.1);  // it sleeps: it is woken again, and sent nothing else
  CHECK(fixture.written(Channel::monitor).size() == 8);
  CHECK(fixture.written(Channel::command).empty());
  fixture.told<AdapterState>();
  const Sky asleep{.bits = (1U << 11) | kWatchdogBit, .demo = false};
  fixture.hear(Channel::monitor, navdata(1, asleep));
  CHECK(fixture.written(Channel::command) == "AT*COMWDG=1\rAT*CONFIG=2,\"general:navdata_demo\",\"TRUE\"\r");
  fixture.hear(Channel::monitor, navdata(2, {.bits = kCommandBit, .demo = false}));
  CHECK(fixture.written(Channel::command) == "AT*CTRL=3,5,0\r");
  CHECK(fixture.told<AdapterState>().empty());
  fixture.hear(Channel::monitor, navdata(3, kOnGround));
  CHECK(fixture.one<AdapterState>().robot == "ONLINE");
  fixture.wait(0);
  CHECK(fixture.written(Channel::command) == "AT*REF=4,290717696\rAT*PCMD=5,0,0,0,0,0\r");
}

TEST_CASE("drone: its state is sent every 30 ms, with rising numbers; nothing else is ever repeated") {
  DroneFixture fixture;
  fixture.command("lights", "[3, 0.5, 2]");
  CHECK(fixture.sent() == Calls{"LED,3,1056964608,2", kRefGround, kHoverCall});
  fixture.live(3, kOnGround);
  const Calls calls = fixture.sent();
  CHECK(calls.size() >= 198);
  CHECK(calls.size() <= 202);
  for (std::size_t i = 0; i < calls.size(); ++i) CHECK(calls[i] == (i % 2 == 0 ? kRefGround : kHoverCall));
}

TEST_CASE("drone: one step is one datagram, at most 1024 bytes of it") {
  Settings settings = drone();
  const std::string line = "CONFIG {data} \"" + std::string(400, 'v') + "\"\n";
  settings.commands.commands["big"] = line + line + line;
  DroneFixture fixture(kOnGround, settings);
  CHECK(fixture.answer(fixture.command("big", "key")) == "nack too_large");
  fixture.collect();
  fixture.robot.writes.clear();
  fixture.command("lights", "[3, 0.5, 2]");
  fixture.collect();
  CHECK(fixture.robot.writes.size() == 1);
}

TEST_CASE("drone: a watchdog that has bitten is told that somebody is there") {
  DroneFixture fixture(kHovering);
  Sky bitten = kHovering;
  bitten.bits = kWatchdogBit;
  fixture.tell(bitten);
  fixture.wait(0.03);
  CHECK(fixture.sent().front() == "COMWDG");
  CHECK(fixture.faults().empty());  // every gap of 50 ms sets the bit
  fixture.tell(kHovering);
  fixture.wait(0.06);
  CHECK(fixture.last("COMWDG").empty());
  fixture.live(0.9, bitten);
  CHECK(fixture.faults().empty());
  fixture.live(0.3, bitten);
  CHECK(fixture.faults().at(0).text.find("watchdog") != std::string::npos);
}

TEST_CASE("drone: navdata that is old, broken or of a wrong checksum is counted and changes nothing") {
  DroneFixture fixture(kHovering);
  fixture.hear(Channel::monitor, navdata(fixture.sequence, kOnGround));
  CHECK(fixture.counted("refused.old_navdata") == 1);
  std::string wrong = navdata(fixture.sequence + 1, kOnGround);
  wrong.back() = '\1';
  fixture.hear(Channel::monitor, wrong);
  CHECK(fixture.counted("refused.wrong_checksum") == 1);
  fixture.hear(Channel::monitor, "hello");
  fixture.hear(Channel::monitor, "");
  CHECK(fixture.counted("refused.bad_navdata") == 2);
  CHECK(fixture.answer(fixture.send(MessageType::request, "state", "")) == "\"hovering\"");
}

TEST_CASE("drone: requests are answered from navdata; an own name may stand for one of its values") {
  DroneFixture fixture(kHovering);
  CHECK(fixture.answer(fixture.send(MessageType::request, "battery", "")) == "76");
  CHECK(fixture.answer(fixture.send(MessageType::request, "height", "")) == "0.812");
  CHECK(fixture.answer(fixture.send(MessageType::request, "yaw", "")) == "-1.570796327");
}

TEST_CASE("drone: after 2 s without navdata it is lost, is sent nothing, and comes back by itself") {
  DroneFixture fixture(kHovering);
  fixture.welcome();
  fixture.told<AdapterState>();
  fixture.execute("hover", R"({"duration": 30})");
  fixture.wait(1.9);
  CHECK(fixture.told<Outcome>().empty());
  fixture.sent();
  fixture.wait(0.2);
  const auto outcome = fixture.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the drone's link was lost: no navdata for 2 s");
  CHECK(fixture.one<RobotConnection>().detail == "no navdata for 2 s");
  const auto faults = fixture.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].severity == Severity::critical);
  CHECK(faults[0].text.find("hovers, then lands by itself") != std::string::npos);
  fixture.sent();
  fixture.wait(3);
  CHECK(fixture.sent().empty());
  CHECK(fixture.written(Channel::monitor).size() >= 8);  // it is woken
  fixture.flags = kFlagTakeControl;
  CHECK(fixture.answer(fixture.command("land", "")) == "nack robot_offline");
  fixture.told<AdapterState>();
  fixture.sequence = 0;  // it was switched off and on: it counts from 1 again
  fixture.tell(kOnGround);
  CHECK(fixture.told<AdapterState>().size() == 1);
  fixture.wait(0);
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("drone: a command that does not fit into the queue of settings leaves nothing behind") {
  Settings settings = drone();
  settings.commands.commands["two"] = "FTRIM\nCONFIG \"a\" {data}\nCONFIG \"b\" {data}";
  DroneFixture fixture(kOnGround, settings);
  for (int i = 0; i < 16; ++i) fixture.command("name", "1");  // one is sent, 15 wait
  fixture.sent();
  CHECK(fixture.answer(fixture.command("two", "2")) == "nack queue_full");
  fixture.wait(0.6);  // after 17 commands at once the next datagram is due
  const auto sent = fixture.sent();
  CHECK_FALSE(sent.empty());
  CHECK(std::ranges::find(sent, "FTRIM") == sent.end());
  CHECK(fixture.answer(fixture.command("name", "3")).empty());  // there is still place for one
}

TEST_CASE("drone: a command that takes off and does not fit into the queue of settings leaves it on the ground") {
  Settings settings = drone();
  settings.commands.commands["up"] = "REF take_off\nCONFIG \"a\" {data}\nCONFIG \"b\" {data}";
  DroneFixture fixture(kOnGround, settings);
  for (int i = 0; i < 16; ++i) fixture.command("name", "1");
  fixture.sent();
  CHECK(fixture.answer(fixture.command("up", "2")) == "nack queue_full");
  fixture.wait(0.6);
  CHECK(fixture.last("REF") == kRefGround);
}

TEST_CASE("drone: what is wrong is told again by a drone that comes back, but not that its watchdog waited for us") {
  Sky low = kHovering;
  low.bits = kBatteryLowBit | kWatchdogBit;
  DroneFixture fixture(low);
  CHECK(fixture.faults().size() == 1);
  fixture.live(0.8, low);
  CHECK(fixture.faults().empty());
  fixture.wait(2.1);
  CHECK(fixture.faults().at(0).text.find("link lost") == 0);
  CHECK(fixture.kept.size() == 1);
  fixture.tell(low);
  CHECK(fixture.over().at(0).find("link lost in the air") != std::string::npos);
  CHECK(fixture.kept.empty());
  CHECK(fixture.faults().at(0).text == "battery low: 76 %");
}

TEST_CASE("drone: whoever takes over finds it in the air and lets it stand there, or land if it lands") {
  CHECK([] {
    DroneFixture fixture(kHovering);
    return fixture.wait(0.03), fixture.last("REF");
  }() == kRefAir);
  CHECK([] {
    DroneFixture fixture(kLanding);
    return fixture.wait(0.03), fixture.last("REF");
  }() == kRefGround);
}

TEST_CASE("drone: a host that has nobody on the port is told at once") {
  DroneFixture fixture(kOnGround);
  fixture.welcome();
  fixture.told<AdapterState>();
  fixture.down(Channel::command, "Connection refused");
  CHECK(fixture.one<AdapterState>().robot == "CONNECTION_BROKEN");
  CHECK(fixture.one<RobotConnection>().detail == "Connection refused");
  CHECK(fixture.faults().at(0).severity == Severity::warning);
  fixture.up(Channel::command);
  fixture.tell(kOnGround);
  CHECK(fixture.one<AdapterState>().robot == "ONLINE");
}

TEST_CASE("drone: a setting is taken once the drone says so, one after the other, and never sent twice") {
  DroneFixture fixture;
  const auto first = fixture.command("name", "\"bee\"");
  const auto second = fixture.command("name", "\"wasp\"");
  CHECK(fixture.last("CONFIG") == "CONFIG,\"general:ardrone_name\",\"bee\"");
  CHECK(fixture.answer(first).empty());
  fixture.live(0.25, kOnGround);
  CHECK(fixture.last("CONFIG").empty());
  Sky taken = kOnGround;
  taken.bits = kCommandBit;
  fixture.tell(taken);
  CHECK(fixture.answer(first) == "ack handed_over");
  fixture.wait(0.03);
  CHECK(fixture.last("C") == "CTRL,5,0");  // the bit is cleared first
  fixture.live(0.125, kOnGround);
  CHECK(fixture.last("CONFIG") == "CONFIG,\"general:ardrone_name\",\"wasp\"");
  fixture.live(1.1, kOnGround);
  CHECK(fixture.nack_of(second).code == "timeout");
  CHECK(fixture.nack_of(second).what ==
        "the drone did not acknowledge CONFIG \"general:ardrone_name\",\"wasp\" within 1 s");
  fixture.tell(taken);  // too late, and for no command
  CHECK(fixture.answer(fixture.command("name", "\"a\\\"b\"")) == "nack not_escapable");
}
