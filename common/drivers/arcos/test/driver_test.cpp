// A Pioneer over ARCOS: golden packets, the hand-shake, values and faults.
#include "common/drivers/arcos/state.hpp"
#include "common/drivers/arcos/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("the hand-shake: SYNC0 to SYNC2 and their echoes, then the robot is opened, stopped and its motors enabled") {
  PioneerBench bench;
  bench.up(Channel::command);
  CHECK(bench.sent() == "fafb03000000");
  bench.hear(Channel::command, *from_hex("fafb03000000"));
  CHECK(bench.sent() == "fafb03010001");
  bench.hear(Channel::command, *from_hex("fafb03010001"));
  CHECK(bench.sent() == "fafb03020002");
  bench.hear(Channel::command, packet(Bytes("\x02Pio\0Pioneer\0p3dx\0", 18)));
  CHECK(bench.sent() == "fafb06013b0100023b" + kStopPacket + "fafb06043b0100053b");
  CHECK(bench.answer(bench.command("speed", "1")) == "nack robot_offline");
  bench.sip_now();
  CHECK(bench.answer(bench.command("speed", "1")) == "ack handed_over");
}

TEST_CASE("a robot that an earlier client has left open is closed first") {
  PioneerBench bench;
  bench.up(Channel::command);
  bench.sent();
  bench.sip_now();
  CHECK(bench.sent() == "fafb03020002");
  bench.sip_now();
  CHECK(bench.sent().empty());
  bench.wait(0.3);
  CHECK(bench.sent() == "fafb03000000");
  bench.hear(Channel::command, packet(Bytes(1, '\0')));
  CHECK(bench.sent() == "fafb03010001");
}

TEST_CASE("what does not answer as ARCOS is given up after four attempts, and told of") {
  PioneerBench bench;
  bench.up(Channel::command);
  bench.wait(3.9);
  CHECK(bench.sent() == "fafb03000000fafb03000000fafb03000000fafb03000000");
  bench.hear(Channel::command, "SSH-2.0-OpenSSH_9.2\r\n");
  bench.wait(0.2);
  CHECK(bench.closed().starts_with("no answer to SYNC0"));
  CHECK(get<NodeProfile>(bench.told<NodeProfile>().back().body).detail.starts_with("no answer to SYNC0"));
}

TEST_CASE("the robot is kept awake by a PULSE a second, and given up when it says nothing for 3 s") {
  PioneerBench bench;
  bench.connect();
  bench.live(2.05);
  CHECK(bench.sent() == "fafb03000000fafb03000000");
  bench.told<RobotConnection>();
  bench.wait(3.1);
  CHECK(bench.closed() == "the robot has said nothing for 3 s;");
  CHECK(bench.one<RobotConnection>().detail == "the robot has said nothing for 3 s");
  CHECK(bench.answer(bench.command("speed", "1")) == "nack robot_offline");
  bench.connect();
  CHECK(bench.answer(bench.command("speed", "1")) == "ack handed_over");
}

TEST_CASE("a command is a packet: the sign of a number is its type") {
  PioneerBench bench;
  bench.connect();
  bench.command("speed", "200");
  CHECK(bench.sent() == "fafb060b3bc800d33b");
  bench.command("speed", "[-199.6]");
  CHECK(bench.sent() == "fafb060b1bc800d31b");
}

TEST_CASE("a number that the robot cannot take reaches it not") {
  PioneerBench bench;
  bench.connect();
  for (const char* data : {"", "fast", "[]", "40000", "nan", "1e999", "200; 300", "[\"200\\n\"]", "{\"a\":1}"}) {
    CAPTURE(data);
    const auto id = bench.command("speed", data);
    CHECK(bench.answer(id) == "nack bad_value");
    CHECK_FALSE(bench.nack_of(id).cure.empty());
  }
  CHECK(bench.answer(bench.command("go_to", "[1, 2]")) == "nack bad_value");
  CHECK(bench.answer(bench.command("go_to", "[1e8, 2, 3]")) == "nack bad_value");
  CHECK(bench.sent().empty());
}

TEST_CASE("a text has its length before it, so that a quote and a newline are nothing but bytes") {
  PioneerBench bench;
  bench.connect();
  CHECK(bench.answer(bench.command("say", "a\"\n\xfa\xfb")) == "ack handed_over");
  CHECK(bench.sent() == hex(packet(Bytes("\x2a\x2b\x05"
                                         "a\"\n\xfa\xfb",
                                         8))));
  CHECK(bench.answer(bench.command("say", std::string(201, 'x'))) == "nack too_large");
}

TEST_CASE("what goes wrong is told once, with the robot's own flags") {
  PioneerBench bench;
  bench.connect();
  bench.live(2);
  CHECK(bench.faults().empty());
  bench.robot.stall = 0x0002;
  bench.live(1);
  auto told = bench.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].capability == "mobile");
  CHECK(told[0].severity == Severity::urgent);
  CHECK(told[0].text == "front bumper 1");
  bench.robot.flags = 0;
  bench.live(1);
  told = bench.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::critical);
  CHECK(told[0].text == "front bumper 1; the motors are off");
  bench.robot.stall = 0;
  bench.live(1);
  CHECK(bench.faults().empty());
  bench.robot = {};
  bench.live(1);
  CHECK(bench.over() == std::vector<std::string>{"mobile: front bumper 1; the motors are off"});
  CHECK(bench.faults().empty());
  bench.robot.flags = 0x20;
  bench.live(0.1);
  told = bench.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::fatal);
}

TEST_CASE("motors that were switched off by word are no fault") {
  PioneerBench bench;
  bench.connect();
  bench.live(2);
  bench.command("relax", "");
  bench.robot.flags = 0;
  bench.live(2);
  CHECK(bench.faults().empty());
  CHECK(bench.answer(bench.send(MessageType::request, "motors", "")) == "false");
}

TEST_CASE("requests are answered in the robot's units, from its last packet") {
  PioneerBench bench;
  bench.connect();
  bench.robot = {1500, -20, -90.02, 0};
  bench.sip_now();
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[1500,-20,-90]");
  CHECK(bench.answer(bench.send(MessageType::request, "voltage", "")) == "12.5");
  CHECK(bench.answer(bench.send(MessageType::request, "weather", "")) == "nack no_field_channel");
}

TEST_CASE("a position that wraps goes on; SETO begins again at 0") {
  PioneerBench bench;
  bench.connect();
  for (int x = 0; x <= 100'000; x += 500) {
    bench.robot.x = x;
    bench.sip_now();
  }
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[100000,0,0]");
  bench.command("origin", "");
  CHECK(bench.sent() == "fafb03070007");
  bench.sip_now();
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[100000,0,0]");
  bench.robot.x = 0;
  bench.sip_now();
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[0,0,0]");
}

TEST_CASE("a connection that comes back finds the robot where it was, or at its origin if it was switched on again") {
  PioneerBench bench;
  bench.connect();
  for (bench.robot.x = 0; bench.robot.x <= 40'000; bench.robot.x += 1000) bench.sip_now();
  bench.down(Channel::command);
  bench.robot.x = 40'100;
  bench.connect();
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[40100,0,0]");
  CHECK(bench.faults().empty());
  bench.down(Channel::command);
  bench.robot.x = 0;
  bench.connect();
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[0,0,0]");
  const auto told = bench.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::warning);
  CHECK(told[0].text.starts_with("its odometry begins again at 0, 40100 mm from where the robot was"));
}

TEST_CASE("garbage and wrong checksums are counted and dropped, the next packet is read") {
  PioneerBench bench;
  bench.connect();
  bench.robot.x = 700;
  Bytes broken = sip({});
  broken[5] = '\x55';
  const Bytes stream = "\xfa\xfa\xfb\x01" + broken + sip(bench.robot);
  for (const char c : stream) bench.hear(Channel::command, Bytes(1, c));
  CHECK(bench.answer(bench.send(MessageType::request, "position", "")) == "[700,0,0]");
  CHECK(bench.counted("refused.bad_checksum") == 1);
  CHECK(bench.counted("refused.garbage") > 0);
  Bytes cut = sip({}).substr(3, 18);
  bench.hear(Channel::command, packet(cut));
  CHECK(bench.counted("refused.bad_packet") == 1);
}

TEST_CASE("an old robot's packet ends with its sonar") {
  Picture robot;
  robot.battery = 131;
  const Bytes whole = sip(robot);
  const auto short_sip = read_arcos_sip({0x32, whole.substr(4, 22)});
  REQUIRE(short_sip);
  CHECK(short_sip->battery == 13.1);
  const auto long_sip = read_arcos_sip({0x32, whole.substr(4, whole.size() - 6)});
  REQUIRE(long_sip);
  CHECK(long_sip->battery == 12.5);
  CHECK(long_sip->digital_in == 5);
  CHECK(long_sip->compass == 90);
}

TEST_CASE("a process that ends closes the robot") {
  PioneerBench bench;
  bench.connect();
  bench.core.leave(bench.now, bench.out);
  CHECK(bench.sent() == kStopPacket + "fafb03020002");
}
