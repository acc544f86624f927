// The link to an AR.Drone: waking it, the state that is sent again and again, settings, and what is lost.
#include "common/drivers/udp-at/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

using Calls = std::vector<std::string>;

TEST_CASE("drone: it is woken, told to tell its flight data, and then counts as there") {
  Bench bench(drone());
  bench.welcome();
  bench.up(Channel::command);
  bench.up(Channel::monitor);
  bench.wait(0);
  CHECK(bench.written(Channel::monitor) == std::string("\1\0\0\0", 4));
  bench.wait(2.1);  // it sleeps: it is woken again, and sent nothing else
  CHECK(bench.written(Channel::monitor).size() == 8);
  CHECK(bench.written(Channel::command).empty());
  bench.told<AdapterState>();
  const Sky asleep{.bits = (1U << 11) | kWatchdogBit, .demo = false};
  bench.hear(Channel::monitor, navdata(1, asleep));
  CHECK(bench.written(Channel::command) == "AT*COMWDG=1\rAT*CONFIG=2,\"general:navdata_demo\",\"TRUE\"\r");
  bench.hear(Channel::monitor, navdata(2, {.bits = kCommandBit, .demo = false}));
  CHECK(bench.written(Channel::command) == "AT*CTRL=3,5,0\r");
  CHECK(bench.told<AdapterState>().empty());
  bench.hear(Channel::monitor, navdata(3, kOnGround));
  CHECK(bench.one<AdapterState>().robot == "ONLINE");
  bench.wait(0);
  CHECK(bench.written(Channel::command) == "AT*REF=4,290717696\rAT*PCMD=5,0,0,0,0,0\r");
}

TEST_CASE("drone: its state is sent every 30 ms, with rising numbers; nothing else is ever repeated") {
  DroneBench bench;
  bench.command("lights", "[3, 0.5, 2]");
  CHECK(bench.sent() == Calls{"LED,3,1056964608,2", kRefGround, kHoverCall});
  bench.live(3, kOnGround);
  const Calls calls = bench.sent();
  CHECK(calls.size() >= 198);
  CHECK(calls.size() <= 202);
  for (std::size_t i = 0; i < calls.size(); ++i) CHECK(calls[i] == (i % 2 == 0 ? kRefGround : kHoverCall));
}

TEST_CASE("drone: one step is one datagram, at most 1024 bytes of it") {
  Settings settings = drone();
  const std::string line = "CONFIG {data} \"" + std::string(400, 'v') + "\"\n";
  settings.commands.commands["big"] = line + line + line;
  DroneBench bench(kOnGround, settings);
  CHECK(bench.answer(bench.command("big", "key")) == "nack too_large");
  bench.out.writes.clear();
  bench.command("lights", "[3, 0.5, 2]");
  CHECK(bench.out.writes.size() == 1);
}

TEST_CASE("drone: a watchdog that has bitten is told that somebody is there") {
  DroneBench bench(kHovering);
  Sky bitten = kHovering;
  bitten.bits = kWatchdogBit;
  bench.tell(bitten);
  bench.wait(0.03);
  CHECK(bench.sent().front() == "COMWDG");
  CHECK(bench.faults().at(0).text.find("watchdog") != std::string::npos);
  bench.tell(kHovering);
  bench.wait(0.06);
  CHECK(bench.last("COMWDG").empty());
}

TEST_CASE("drone: navdata that is old, broken or of a wrong checksum is counted and changes nothing") {
  DroneBench bench(kHovering);
  bench.hear(Channel::monitor, navdata(bench.sequence, kOnGround));
  CHECK(bench.counted("refused.old_navdata") == 1);
  std::string wrong = navdata(bench.sequence + 1, kOnGround);
  wrong.back() = '\1';
  bench.hear(Channel::monitor, wrong);
  CHECK(bench.counted("refused.wrong_checksum") == 1);
  bench.hear(Channel::monitor, "hello");
  bench.hear(Channel::monitor, "");
  CHECK(bench.counted("refused.bad_navdata") == 2);
  CHECK(bench.answer(bench.send(MessageType::request, "state", "")) == "\"hovering\"");
}

TEST_CASE("drone: requests are answered from navdata; an own name may stand for one of its values") {
  DroneBench bench(kHovering);
  CHECK(bench.answer(bench.send(MessageType::request, "battery", "")) == "76");
  CHECK(bench.answer(bench.send(MessageType::request, "height", "")) == "0.812");
  CHECK(bench.answer(bench.send(MessageType::request, "yaw", "")) == "-1.570796327");
}

TEST_CASE("drone: after 2 s without navdata it is lost, is sent nothing, and comes back by itself") {
  DroneBench bench(kHovering);
  bench.welcome();
  bench.told<AdapterState>();
  bench.execute("hover", R"({"duration": 30})");
  bench.wait(1.9);
  CHECK(bench.told<Outcome>().empty());
  bench.sent();
  bench.wait(0.2);
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::interrupted);
  CHECK(outcome.reason == "the drone's link was lost: no navdata for 2 s");
  CHECK(bench.one<RobotConnection>().detail == "no navdata for 2 s");
  const auto faults = bench.faults();
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].severity == Severity::critical);
  CHECK(faults[0].text.find("hovers, then lands by itself") != std::string::npos);
  bench.sent();
  bench.wait(3);
  CHECK(bench.sent().empty());
  CHECK(bench.written(Channel::monitor).size() >= 8);  // it is woken
  bench.flags = kFlagTakeControl;
  CHECK(bench.answer(bench.command("land", "")) == "nack robot_offline");
  bench.told<AdapterState>();
  bench.sequence = 0;  // it was switched off and on: it counts from 1 again
  bench.tell(kOnGround);
  CHECK(bench.told<AdapterState>().size() == 1);
  bench.wait(0);
  CHECK(bench.last("REF") == kRefGround);
}

TEST_CASE("drone: a command that does not fit into the queue of settings leaves nothing behind") {
  Settings settings = drone();
  settings.commands.commands["two"] = "FTRIM\nCONFIG \"a\" {data}\nCONFIG \"b\" {data}";
  DroneBench bench(kOnGround, settings);
  for (int i = 0; i < 16; ++i) bench.command("name", "1");  // one is sent, 15 wait
  bench.sent();
  CHECK(bench.answer(bench.command("two", "2")) == "nack queue_full");
  bench.wait(0.03);
  CHECK(bench.last("FTRIM").empty());
  CHECK(bench.answer(bench.command("name", "3")).empty());  // there is still place for one
}

TEST_CASE("drone: what is wrong is told again by a drone that comes back, but not that its watchdog waited for us") {
  Sky low = kHovering;
  low.bits = kBatteryLowBit | kWatchdogBit;
  DroneBench bench(low);
  CHECK(bench.faults().size() == 1);
  bench.live(1, low);
  CHECK(bench.faults().empty());
  bench.wait(2.1);
  CHECK(bench.faults().at(0).text.find("link lost") == 0);
  CHECK(bench.kept.size() == 1);
  bench.tell(low);
  CHECK(bench.over().at(0).find("link lost in the air") != std::string::npos);
  CHECK(bench.kept.empty());
  CHECK(bench.faults().at(0).text == "battery low: 76 %");
}

TEST_CASE("drone: whoever takes over finds it in the air and lets it stand there, or land if it lands") {
  CHECK([] {
    DroneBench bench(kHovering);
    return bench.wait(0.03), bench.last("REF");
  }() == kRefAir);
  CHECK([] {
    DroneBench bench(kLanding);
    return bench.wait(0.03), bench.last("REF");
  }() == kRefGround);
}

TEST_CASE("drone: a host that has nobody on the port is told at once") {
  DroneBench bench(kOnGround);
  bench.welcome();
  bench.told<AdapterState>();
  bench.down(Channel::command, "Connection refused");
  CHECK(bench.one<AdapterState>().robot == "CONNECTION_BROKEN");
  CHECK(bench.one<RobotConnection>().detail == "Connection refused");
  CHECK(bench.faults().at(0).severity == Severity::warning);
  bench.up(Channel::command);
  bench.tell(kOnGround);
  CHECK(bench.one<AdapterState>().robot == "ONLINE");
}

TEST_CASE("drone: a setting is taken once the drone says so, one after the other, and never sent twice") {
  DroneBench bench;
  const auto first = bench.command("name", "\"bee\"");
  const auto second = bench.command("name", "\"wasp\"");
  CHECK(bench.last("CONFIG") == "CONFIG,\"general:ardrone_name\",\"bee\"");
  CHECK(bench.answer(first).empty());
  bench.live(0.25, kOnGround);
  CHECK(bench.last("CONFIG").empty());
  Sky taken = kOnGround;
  taken.bits = kCommandBit;
  bench.tell(taken);
  CHECK(bench.answer(first) == "ack handed_over");
  bench.wait(0.03);
  CHECK(bench.last("C") == "CTRL,5,0");  // the bit is put down first
  bench.live(0.125, kOnGround);
  CHECK(bench.last("CONFIG") == "CONFIG,\"general:ardrone_name\",\"wasp\"");
  bench.live(1.1, kOnGround);
  CHECK(bench.nack_of(second).code == "timeout");
  CHECK(bench.nack_of(second).what ==
        "the drone did not acknowledge CONFIG \"general:ardrone_name\",\"wasp\" within 1 s");
  bench.tell(taken);  // too late, and of nobody
  CHECK(bench.answer(bench.command("name", "\"a\\\"b\"")) == "nack not_escapable");
}
