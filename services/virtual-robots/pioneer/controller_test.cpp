#include "services/virtual-robots/pioneer/controller.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace trb::virtual_robots::pioneer;

namespace {

using Lines = std::vector<std::string>;

std::string command(int number) {
  return PacketWriter(number).packet();
}

std::string command(int number, int value) {
  return PacketWriter(number).byte(value < 0 ? 0x1b : 0x3b).word(std::abs(value)).packet();
}

/** A robot, its client, and the clock of both. */
struct Fixture {
  explicit Fixture(const Start& start = {}) : robot(start) {}

  std::string send(const std::string& packet) { return robot.take(packet, now); }
  void connect() {
    for (const int sync : {0, 1, 2}) send(command(sync));
    send(command(1, 1));
    send(command(4, 1));
    lines();
  }
  /** The client sends signs of life meanwhile. */
  void wait(double seconds) {
    double left = seconds;
    while (left > 1e-9) {
      send(command(0));
      pass(std::min(left, 0.1));
      left -= 0.1;
    }
  }
  /** VEL: so many millimetres a second, for that long. */
  void drive(int speed, double seconds) {
    send(command(11, speed));
    wait(seconds);
  }
  void pass(double seconds) { robot.advance(seconds, now += seconds); }

  int word(std::size_t at) {
    const std::string sip = robot.sip();
    REQUIRE(sip.size() > at + 3);
    const auto low = static_cast<unsigned char>(sip[at]);
    return static_cast<std::int16_t>(low | static_cast<unsigned char>(sip[at + 1]) << 8);
  }
  int type() { return robot.sip().at(3); }
  int x() { return word(4); }
  int y() { return word(6); }
  int degrees() { return static_cast<int>(std::lround(word(8) * 360.0 / 4096)); }
  int left() { return word(10); }
  int right() { return word(12); }
  int stall() { return word(15); }
  int flags() { return word(19); }
  Lines lines() { return robot.take_lines(); }
  /** True if it last reported that it stands there, within 2 mm and 0.002 radians. */
  bool stands_at(double x, double y, double heading) {
    const Lines said = lines();
    double at[3] = {};
    if (said.empty() || std::sscanf(said.back().c_str(), "at %lf %lf %lf", &at[0], &at[1], &at[2]) != 3) return false;
    return std::hypot(at[0] - x, at[1] - y) <= 0.002 && std::abs(at[2] - heading) <= 0.002;
  }

  Controller robot;
  double now = 100;
};

/** Its client is connected. */
struct Connected : Fixture {
  Connected() { connect(); }
};

}  // namespace

TEST_CASE("pioneer: three SYNCs are echoed, the last one with the robot's name, class and subclass") {
  Fixture fixture;
  CHECK(fixture.send(command(0)) == command(0));
  CHECK(fixture.send(command(1)) == command(1));
  CHECK(fixture.send(command(2)) == PacketWriter(2).text("Pioneer").text("Pioneer").text("p3dx-sh").packet());
  CHECK(fixture.robot.sip().empty());
  fixture.send(command(1, 1));
  CHECK(fixture.type() == 0x32);
}

TEST_CASE("pioneer: a SYNC out of sequence begins again") {
  Fixture fixture;
  CHECK(fixture.send(command(1)) == command(255));
  CHECK(fixture.send(command(0)) == command(0));
  CHECK(fixture.send(command(0)) == command(0));
  CHECK(fixture.send(command(1)) == command(1));
}

TEST_CASE("pioneer: a MOVE speeds up, drives and stands where it was told to") {
  Connected fixture;
  fixture.send(command(8, 1000));
  fixture.wait(1);
  CHECK(fixture.type() == 0x33);
  CHECK(fixture.left() == doctest::Approx(300).epsilon(0.02));
  CHECK(fixture.x() == doctest::Approx(150).epsilon(0.02));
  fixture.wait(4);
  CHECK(fixture.type() == 0x32);
  CHECK(std::abs(fixture.x() - 1000) <= 2);
  CHECK(fixture.stands_at(1, 0, 0));
}

TEST_CASE("pioneer: HEAD turns the shorter way, DHEAD on from there") {
  Connected fixture;
  fixture.send(command(12, -90));
  fixture.wait(0.5);
  CHECK(fixture.left() > 0);
  CHECK(fixture.right() == -fixture.left());
  fixture.wait(4);
  CHECK(fixture.degrees() == -90);
  fixture.send(command(13, 45));
  fixture.wait(4);
  CHECK(fixture.degrees() == -45);
  CHECK(fixture.y() == 0);
}

TEST_CASE("pioneer: STOP brakes within its limit, E_STOP harder") {
  Connected fixture;
  fixture.drive(300, 2);
  fixture.send(command(29));
  fixture.wait(0.5);
  CHECK(fixture.left() == doctest::Approx(150).epsilon(0.05));
  fixture.send(command(55));
  fixture.wait(0.2);
  CHECK(fixture.left() == 0);
}

TEST_CASE("pioneer: SETO is the new origin, and the hall stays where it is") {
  Start start;
  start.place = {1, 3, M_PI / 2};
  Fixture fixture(start);
  fixture.connect();
  fixture.send(command(8, 500));
  fixture.wait(5);
  CHECK(fixture.stands_at(1, 3.5, M_PI / 2));
  fixture.send(command(7));
  CHECK(fixture.x() == 0);
  fixture.send(command(8, 500));
  fixture.wait(5);
  CHECK(fixture.stands_at(1, 4, M_PI / 2));
}

TEST_CASE("pioneer: its counters have 15 bits: a millimetre behind its origin is 32767, and 33 m are 232 mm") {
  Connected fixture;
  fixture.send(command(8, -1));
  fixture.wait(2);
  CHECK(fixture.x() == 0x7fff);
  fixture.send(command(7));
  fixture.send(command(6, 1500));
  for (int i = 0; i < 7; ++i) {
    fixture.send(command(8, 4900));
    fixture.wait(40);
  }
  CHECK(std::abs(fixture.x() - (7 * 4900 - 32768)) <= 3);
}

TEST_CASE("pioneer: without a packet for 2 s it halts, and goes on with the next one") {
  Connected fixture;
  fixture.drive(200, 1);
  for (int i = 0; i < 30; ++i) fixture.pass(0.1);
  CHECK(fixture.left() == 0);
  CHECK(fixture.lines().back().starts_with("at "));
  fixture.send(command(0));
  CHECK(fixture.lines() == Lines{"watchdog resumed"});
  fixture.wait(1);
  CHECK(fixture.left() == 200);
}

TEST_CASE("pioneer: with its motors off it does not move") {
  Connected fixture;
  fixture.send(command(4, 0));
  CHECK((fixture.flags() & 1) == 0);
  fixture.drive(200, 1);
  CHECK(fixture.left() == 0);
  fixture.send(command(4, 1));
  fixture.wait(1);
  CHECK(fixture.left() == 0);
}

TEST_CASE("pioneer: each fault ends the motion as the robot's own would") {
  Connected fixture;
  fixture.drive(200, 1);
  fixture.robot.set_fault(Fault::stall, "a box");
  CHECK(fixture.left() == 0);
  CHECK(fixture.stall() == 0x0103);
  CHECK((fixture.flags() & 1) == 1);
  fixture.robot.set_fault(Fault::stop_button, "");
  CHECK((fixture.flags() & 0x21) == 0x20);
  fixture.send(command(4, 1));
  CHECK((fixture.flags() & 1) == 0);
  fixture.robot.set_fault(Fault::none, "");
  fixture.send(command(4, 1));
  CHECK((fixture.flags() & 0x21) == 1);
  CHECK(fixture.stall() == 0);
}

TEST_CASE("pioneer: CLOSE switches the motors off and waits for the next SYNC0") {
  Connected fixture;
  fixture.drive(200, 1);
  fixture.send(command(2));
  CHECK(fixture.robot.sip().empty());
  CHECK(fixture.send(command(0)) == command(0));
  fixture.connect();
  CHECK(fixture.left() == 0);
}

TEST_CASE("pioneer: the battery drains, faster on the way") {
  Connected fixture;
  const auto tenths = [&] { return static_cast<unsigned char>(fixture.robot.sip().at(14)); };
  CHECK(tenths() == 128);
  for (int i = 0; i < 360; ++i) fixture.pass(10);
  CHECK(tenths() == 125);
}

TEST_CASE("pioneer: it tells its settings when it is asked for them") {
  Connected fixture;
  const std::string answer = fixture.send(command(18));
  CHECK(answer.substr(3, 24) == std::string("\x20Pioneer\0p3dx-sh\0VIRTUAL\0", 25).substr(0, 24));
  CHECK(answer.size() == static_cast<unsigned char>(answer[2]) + 3U);
}

namespace {

/** A CONFIGpac by the manual's table: every field in its order. */
class Config {
 public:
  explicit Config(const std::string& packet) : rest_(packet.substr(4, packet.size() - 6)) {}
  std::string text() {
    std::string out = rest_.substr(0, rest_.find('\0'));
    rest_.erase(0, out.size() + 1);
    return out;
  }
  int byte() {
    const int out = static_cast<unsigned char>(rest_.at(0));
    rest_.erase(0, 1);
    return out;
  }
  int word() {
    const int low = byte();
    return low | byte() << 8;
  }
  std::vector<int> words(int count) {
    std::vector<int> out;
    for (; count > 0; --count) out.push_back(word());
    return out;
  }
  bool empty() const { return rest_.empty(); }

 private:
  std::string rest_;
};

struct Told {
  int rev_count = 0, stall_val = 0, ticks_mm = 0;
  std::vector<int> turn, drive;  // speed is apart: acceleration, deceleration, Kp, Kv, Ki
  bool whole = false;
};

Told told(const std::string& packet) {
  Config config(packet);
  for (int i = 0; i < 3; ++i) config.text();  // type, subtype, serial number
  config.byte();                              // 4Mots
  config.words(5);                            // RotVelTop, TransVelTop, RotAccTop, TransAccTop, PwmMax
  config.text();                              // name
  for (int i = 0; i < 3; ++i) config.byte();  // SIPcycle, HostBaud, AuxBaud
  config.words(2);                            // Gripper, FrontSonar
  config.byte();                              // RearSonar
  config.word();                              // LowBattery
  Told out;
  out.rev_count = config.word();
  config.word();  // WatchDog
  config.byte();  // P2Mpacs
  out.stall_val = config.word();
  config.words(5);  // StallCount, JoyVel, JoyRVel, RotVelMax, TransVelMax
  out.turn = config.words(5);
  out.drive = config.words(5);
  for (int i = 0; i < 6; ++i) config.byte();  // FrontBumps, RearBumps, Charger, SonarCycle, AutoBaud, HasGyro
  config.word();                              // DriftFactor
  config.words(1);                            // Aux2Baud, Aux3Baud
  out.ticks_mm = config.word();
  config.word();  // ShutdownVolts
  config.text();  // version
  config.words(2);
  config.byte();  // gyro's factors, kinematics delay
  out.whole = config.empty();
  return out;
}

}  // namespace

TEST_CASE("pioneer: its CONFIGpac has encoders, stall and gains where the manual has them, as commands changed them") {
  Connected fixture;
  const Told at_first = told(fixture.send(command(18)));
  CHECK(at_first.whole);
  CHECK(at_first.ticks_mm == 128);
  CHECK(at_first.rev_count == 16570);
  CHECK(at_first.stall_val == 200);
  CHECK(at_first.turn == std::vector<int>{100, 100, 40, 20, 0});
  CHECK(at_first.drive == std::vector<int>{300, 300, 40, 30, 0});
  for (int number = 82; number <= 87; ++number) fixture.send(command(number, number));
  fixture.send(command(88, 17000));
  fixture.send(command(93, 130));
  const Told changed = told(fixture.send(command(18)));
  CHECK(changed.turn == std::vector<int>{100, 100, 82, 83, 84});
  CHECK(changed.drive == std::vector<int>{300, 300, 85, 86, 87});
  CHECK(changed.rev_count == 17000);
  CHECK(changed.ticks_mm == 130);
}
