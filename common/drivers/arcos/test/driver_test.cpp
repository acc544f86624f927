// A Pioneer over ARCOS: golden packets, the hand-shake, values and faults.
#include "common/drivers/arcos/state.hpp"
#include "common/drivers/arcos/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

TEST_CASE("the hand-shake: SYNC0 to SYNC2 and their echoes, then the robot is opened, stopped and its motors enabled") {
  PioneerFixture fixture;
  fixture.up(Channel::command);
  CHECK(fixture.sent() == "fafb03000000");
  fixture.hear(Channel::command, *from_hex("fafb03000000"));
  CHECK(fixture.sent() == "fafb03010001");
  fixture.hear(Channel::command, *from_hex("fafb03010001"));
  CHECK(fixture.sent() == "fafb03020002");
  fixture.hear(Channel::command, packet(Bytes("\x02Pio\0Pioneer\0p3dx\0", 18)));
  CHECK(fixture.sent() == "fafb06013b0100023b" + kStopPacket + "fafb06043b0100053b");
  CHECK(fixture.answer(fixture.command("speed", "1")) == "nack robot_offline");
  fixture.sip_now();
  CHECK(fixture.answer(fixture.command("speed", "1")) == "ack handed_over");
}

TEST_CASE("a robot that an earlier client has left open is closed first") {
  PioneerFixture fixture;
  fixture.up(Channel::command);
  fixture.sent();
  fixture.sip_now();
  CHECK(fixture.sent() == "fafb03020002");
  fixture.sip_now();
  CHECK(fixture.sent().empty());
  fixture.wait(0.3);
  CHECK(fixture.sent() == "fafb03000000");
  fixture.hear(Channel::command, packet(Bytes(1, '\0')));
  CHECK(fixture.sent() == "fafb03010001");
}

TEST_CASE(
    "what does not answer as ARCOS is closed, in case somebody left it synced, and given up after four attempts") {
  PioneerFixture fixture;
  fixture.up(Channel::command);
  fixture.wait(3.9);
  CHECK(fixture.sent() == "fafb03000000fafb03020002fafb03000000fafb03020002fafb03000000fafb03020002fafb03000000");
  fixture.hear(Channel::command, "SSH-2.0-OpenSSH_9.2\r\n");
  fixture.wait(0.2);
  CHECK(fixture.closed().starts_with("no answer to SYNC0"));
  CHECK(get<NodeProfile>(fixture.told<NodeProfile>().back().body).detail.starts_with("no answer to SYNC0"));
}

TEST_CASE("the robot is kept awake by a PULSE a second, and given up when it says nothing for 3 s") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.live(2.05);
  CHECK(fixture.sent() == "fafb03000000fafb03000000");
  fixture.told<RobotConnection>();
  fixture.wait(3.1);
  CHECK(fixture.closed() == "the robot has said nothing for 3 s;");
  CHECK(fixture.one<RobotConnection>().detail == "the robot has said nothing for 3 s");
  CHECK(fixture.answer(fixture.command("speed", "1")) == "nack robot_offline");
  fixture.connect();
  CHECK(fixture.answer(fixture.command("speed", "1")) == "ack handed_over");
}

TEST_CASE("a command is a packet: the sign of a number is its type") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.command("speed", "200");
  CHECK(fixture.sent() == "fafb060b3bc800d33b");
  fixture.command("speed", "[-199.6]");
  CHECK(fixture.sent() == "fafb060b1bc800d31b");
}

TEST_CASE("a number that the robot cannot take reaches it not") {
  PioneerFixture fixture;
  fixture.connect();
  for (const char* data : {"", "fast", "[]", "40000", "nan", "1e999", "200; 300", "[\"200\\n\"]", "{\"a\":1}"}) {
    CAPTURE(data);
    const auto id = fixture.command("speed", data);
    CHECK(fixture.answer(id) == "nack bad_value");
    CHECK_FALSE(fixture.nack_of(id).hint.empty());
  }
  CHECK(fixture.answer(fixture.command("go_to", "[1, 2]")) == "nack bad_value");
  CHECK(fixture.answer(fixture.command("go_to", "[1e8, 2, 3]")) == "nack bad_value");
  CHECK(fixture.sent().empty());
}

TEST_CASE("a text has its length before it, so that a quote and a newline are nothing but bytes") {
  PioneerFixture fixture;
  fixture.connect();
  CHECK(fixture.answer(fixture.command("say", "a\"\n\xfa\xfb")) == "ack handed_over");
  CHECK(fixture.sent() == hex(packet(Bytes("\x2a\x2b\x05"
                                           "a\"\n\xfa\xfb",
                                           8))));
  CHECK(fixture.answer(fixture.command("say", std::string(201, 'x'))) == "nack too_large");
}

TEST_CASE("what goes wrong is told once, with the robot's own flags") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.live(2);
  CHECK(fixture.faults().empty());
  fixture.robot.stall = 0x0002;
  fixture.live(1);
  auto told = fixture.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].capability == "mobile");
  CHECK(told[0].severity == Severity::urgent);
  CHECK(told[0].text == "front bumper 1");
  fixture.robot.flags = 0;
  fixture.live(1);
  told = fixture.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::critical);
  CHECK(told[0].text == "front bumper 1; the motors are off");
  fixture.robot.stall = 0;
  fixture.live(1);
  CHECK(fixture.faults().empty());
  fixture.robot = {};
  fixture.live(1);
  CHECK(fixture.over() == std::vector<std::string>{"mobile: front bumper 1; the motors are off"});
  CHECK(fixture.faults().empty());
  fixture.robot.flags = 0x20;
  fixture.live(0.1);
  told = fixture.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::fatal);
}

TEST_CASE("motors that were switched off by word are no fault") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.live(2);
  fixture.command("relax", "");
  fixture.robot.flags = 0;
  fixture.live(2);
  CHECK(fixture.faults().empty());
  CHECK(fixture.answer(fixture.send(MessageType::request, "motors", "")) == "false");
}

TEST_CASE("requests are answered in the robot's units, from its last packet") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.robot = {1500, -20, -90.02, 0};
  fixture.sip_now();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[1500,-20,-90]");
  CHECK(fixture.answer(fixture.send(MessageType::request, "voltage", "")) == "12.5");
  CHECK(fixture.answer(fixture.send(MessageType::request, "weather", "")) == "nack no_field_channel");
}

TEST_CASE("a position that wraps goes on; SETO begins again at 0") {
  PioneerFixture fixture;
  fixture.connect();
  for (int x = 0; x <= 100'000; x += 500) {
    fixture.robot.x = x;
    fixture.sip_now();
  }
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[100000,0,0]");
  fixture.command("origin", "");
  CHECK(fixture.sent() == "fafb03070007");
  fixture.sip_now();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[100000,0,0]");
  fixture.robot.x = 0;
  fixture.sip_now();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[0,0,0]");
}

TEST_CASE("counters have 15 bits: a robot a millimetre behind its origin tells 32767, and is at -1") {
  PioneerFixture fixture;
  fixture.robot.x = 0x7fff;
  fixture.robot.y = 0x7ffe;
  fixture.connect();
  fixture.sip_now();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[-1,-2,0]");
  fixture.robot.x = 4;
  fixture.robot.y = 0xffff;  // the 16th bit is no part of it
  fixture.sip_now();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[4,-1,0]");
  for (int x = 0x8004; x > 0x4000; x -= 500) {
    fixture.robot.x = x & 0x7fff;
    fixture.sip_now();
  }
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[-15996,-1,0]");
}

TEST_CASE("a connection that comes back finds the robot where it was, or at its origin if it was switched on again") {
  PioneerFixture fixture;
  fixture.connect();
  for (fixture.robot.x = 0; fixture.robot.x <= 40'000; fixture.robot.x += 1000) fixture.sip_now();
  fixture.down(Channel::command);
  fixture.robot.x = 40'100;
  fixture.connect();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[40100,0,0]");
  CHECK(fixture.faults().empty());
  fixture.down(Channel::command);
  fixture.robot.x = 0;
  fixture.connect();
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[0,0,0]");
  const auto told = fixture.faults();
  REQUIRE(told.size() == 1);
  CHECK(told[0].severity == Severity::warning);
  CHECK(told[0].text.starts_with("its odometry begins again at 0, 40100 mm from where the robot was"));
}

TEST_CASE("garbage and wrong checksums are counted and dropped, the next packet is read") {
  PioneerFixture fixture;
  fixture.connect();
  fixture.robot.x = 700;
  Bytes broken = sip({});
  broken[5] = '\x55';
  const Bytes stream = "\xfa\xfa\xfb\x01" + broken + sip(fixture.robot);
  for (const char c : stream) fixture.hear(Channel::command, Bytes(1, c));
  CHECK(fixture.answer(fixture.send(MessageType::request, "position", "")) == "[700,0,0]");
  CHECK(fixture.counted("refused.bad_checksum") == 1);
  CHECK(fixture.counted("refused.garbage") > 0);
  Bytes cut = sip({}).substr(3, 18);
  fixture.hear(Channel::command, packet(cut));
  CHECK(fixture.counted("refused.bad_packet") == 1);
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
  PioneerFixture fixture;
  fixture.connect();
  fixture.core.leave(fixture.now, fixture.out);
  CHECK(fixture.sent() == kStopPacket + "fafb03020002");
}
