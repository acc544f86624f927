// The virtual drone, driven by hand: bytes in, bytes out, no socket and no clock.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "services/virtual-robots/drone/controller.hpp"

using namespace trb::virtual_robots::drone;

namespace {

/** A drone, its real-time clock, and a client that counts its commands. */
class Pilot {
 public:
  explicit Pilot(double speed = 1) : drone_(speed, 0) { drone_.wake(true); }

  void send(const std::string& name, const std::string& arguments = "") {
    drone_.take("AT*" + name + "=" + std::to_string(++sequence_) + (arguments.empty() ? "" : "," + arguments) + "\r",
                now_);
  }
  void raw(const std::string& datagram) { drone_.take(datagram, now_); }
  /** The state, sent as a real client sends it. */
  void fly(double seconds, const std::string& reference, const std::string& motion = "0,0,0,0,0") {
    for (int left = static_cast<int>(std::ceil((seconds - 1e-9) / 0.03)); left > 0; --left) {
      now_ += 0.03;
      send("REF", reference);
      send("PCMD", motion);
    }
  }
  /** In the steps of the loop around it. */
  void pass(double seconds) {
    double left = seconds;
    while (left > 0) {
      drone_.advance(now_ += std::min(left, 0.05));
      left -= 0.05;
    }
  }
  bool said(const std::string& line) {
    for (std::string& event : drone_.take_events()) events_.push_back(std::move(event));
    return std::find(events_.begin(), events_.end(), line) != events_.end();
  }
  std::uint32_t state() {
    const std::string packet = drone_.navdata();
    std::uint32_t out = 0;
    for (int i = 3; i >= 0; --i)
      out = out << 8 | static_cast<unsigned char>(packet[std::size_t{4} + static_cast<std::size_t>(i)]);
    return out;
  }
  Controller& drone() { return drone_; }
  const Aircraft& aircraft() { return drone_.aircraft(); }
  std::uint32_t sequence_ = 0;

 private:
  Controller drone_;
  double now_ = 0;
  std::vector<std::string> events_;
};

const std::string kGround = "290717696";
const std::string kAir = "290718208";
const std::string kToggle = "290717952";

std::string hex(const std::string& bytes) {
  std::string out;
  for (const char byte : bytes) {
    out += "0123456789abcdef"[static_cast<unsigned char>(byte) >> 4];
    out += "0123456789abcdef"[static_cast<unsigned char>(byte) & 15];
  }
  return out;
}

}  // namespace

TEST_CASE("commands: names, numbers, texts with commas, several in a datagram") {
  const Datagram read = parse_datagram("AT*REF=1,290718208\rAT*CONFIG=2,\"a:b\",\"18,15\"\rAT*FTRIM=3\r");
  REQUIRE(read.commands.size() == 3);
  CHECK(read.commands[0].name == "REF");
  CHECK(integer_argument(read.commands[0], 0) == 290718208);
  CHECK(read.commands[1].arguments == std::vector<std::string>{"a:b", "18,15"});
  CHECK(read.commands[2].sequence == 3);
  CHECK(float_argument(parse_datagram("AT*PCMD=1,1,0,-1085485875,0,0\r").commands[0], 2) == -0.8F);
  for (const char* bad : {"AT*REF=1", "AT*REF\r", "REF=1\r", "AT*=1\r", "AT*REF=x\r", "AT*REF=-1\r", "AT*ref=1\r",
                          "AT*CONFIG=1,\"a\r", "AT*CONFIG=1,\"a\"b\r", "AT*CONFIG=1,a\"b\r", "AT*REF=4294967296\r"}) {
    CAPTURE(bad);
    CHECK(parse_datagram(bad).commands.empty());
    CHECK(parse_datagram(bad).rejected.size() == 1);
  }
  CHECK(parse_datagram(std::string(1025, 'x')).rejected.size() == 1);
}

TEST_CASE("navdata: the golden bytes") {
  Aircraft aircraft;
  const std::string bare = navdata_packet(bits::kBootstrap, 1, aircraft, {}, 0);
  CHECK(hex(bare) == "88776655000800000100000001000000ffff0800c4010000");
  const std::string demo = navdata_packet(bits::kDemo, 0x0102, aircraft, {NavdataKind::demo, 1U << 0}, 0);
  CHECK(demo.size() == 172);
  CHECK(hex(demo).substr(0, 64) == "8877665500040000020100000100000000009400000002006400000000000000");
  CHECK(hex(demo).substr(328) == "ffff0800bc020000");
  CHECK(navdata_packet(bits::kDemo, 1, aircraft, {NavdataKind::demo}, 0).size() == 500);
}

namespace {

/** The options of a datagram by tag, each without its header; what navdata_common.h calls a structure. */
std::map<std::uint32_t, std::string> options_of(const std::string& packet) {
  const auto number = [&](std::size_t at, int size) {
    std::uint32_t out = 0;
    while (size-- > 0) out = out << 8U | static_cast<unsigned char>(packet.at(at + static_cast<std::size_t>(size)));
    return out;
  };
  std::map<std::uint32_t, std::string> out;
  for (std::size_t at = 16; at < packet.size(); at += number(at + 2, 2)) {
    out[number(at, 2)] = packet.substr(at + 4, number(at + 2, 2) - 4);
  }
  return out;
}

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 4; i-- > 0;) out = out << 8U | static_cast<unsigned char>(bytes.at(at + i));
  return out;
}

float real(const std::string& bytes, std::size_t at) {
  return std::bit_cast<float>(word(bytes, at));
}

}  // namespace

TEST_CASE("all options are sent to who wants no demo, by their tags and sizes, and the bits say so") {
  Pilot pilot(10);
  pilot.fly(0.6, kAir);
  pilot.fly(0.3, kAir, "1,0,0,0,1056964608");  // turns right
  pilot.send("CONFIG", "\"general:navdata_demo\",\"FALSE\"");
  CHECK((pilot.state() & (bits::kBootstrap | bits::kDemo)) == 0);
  auto options = options_of(pilot.drone().navdata());
  REQUIRE(options.size() == 29);
  const std::map<std::uint32_t, std::size_t> sizes = {{0, 148}, {1, 8},   {2, 52},  {3, 46},   {4, 16},   {6, 88},
                                                      {9, 76},  {10, 56}, {13, 92}, {14, 108}, {15, 364}, {16, 328},
                                                      {19, 65}, {21, 18}, {22, 75}, {27, 12}};
  for (const auto& wanted : sizes) {
    CAPTURE(wanted.first);
    CHECK(options[wanted.first].size() == wanted.second - 4);
  }
  const auto altitude = static_cast<std::int32_t>(word(options[0], 20));
  CHECK(altitude > 500);
  CHECK(static_cast<std::int32_t>(word(options[10], 0)) == altitude);
  CHECK((word(options[1], 0) >> 21U) == 0);
  CHECK(double(word(options[1], 0) & 0x1fffffU) == doctest::Approx(900'000).epsilon(0.01));
  CHECK(word(options[2], 16) > 12'000);
  CHECK(real(options[3], 14) == -1000);
  CHECK(real(options[22], 42) == doctest::Approx(real(options[0], 16) / 1000));
}

TEST_CASE("the demo comes with the options that were asked for; vision_detect is one if none were") {
  Pilot pilot;
  pilot.send("CONFIG", "\"general:navdata_demo\",\"TRUE\"");
  CHECK(options_of(pilot.drone().navdata()).contains(16));
  pilot.send("CONFIG", "\"general:navdata_options\",\"3\"");
  const auto options = options_of(pilot.drone().navdata());
  CHECK(options.size() == 3);
  CHECK(options.contains(1));
}

TEST_CASE("a healthy drone says that its camera and its PIC's version are well") {
  Pilot pilot;
  CHECK((pilot.state() & (bits::kCameraReady | bits::kPicVersionOk)) == (bits::kCameraReady | bits::kPicVersionOk));
  CHECK(bits::kCameraReady == 0x80);
  CHECK(bits::kPicVersionOk == 0x800000);
}

TEST_CASE("take-off, hover and land take their time") {
  Pilot pilot;
  pilot.fly(0.3, kAir);
  CHECK(pilot.aircraft().phase() == Phase::taking_off);
  CHECK((pilot.state() & bits::kFlying) != 0);
  pilot.fly(2, kAir);
  CHECK(pilot.aircraft().phase() == Phase::hovering);
  CHECK(pilot.aircraft().altitude() == doctest::Approx(0.8).epsilon(0.05));
  pilot.fly(0.5, kGround);
  CHECK(pilot.aircraft().phase() == Phase::landing);
  pilot.fly(2, kGround);
  CHECK(pilot.aircraft().phase() == Phase::landed);
  CHECK((pilot.state() & bits::kFlying) == 0);
  CHECK(pilot.said("state landed"));
}

TEST_CASE("it flies where it is tilted to, and stands when it is told to hover") {
  Pilot pilot;
  pilot.fly(2.5, kAir);
  pilot.fly(2, kAir, "1,0,-1085485875,0,0");  // pitch -0.8: forward
  CHECK(pilot.aircraft().forward_speed() == doctest::Approx(2.4).epsilon(0.02));
  CHECK(pilot.aircraft().phase() == Phase::flying);
  CHECK(pilot.aircraft().x() > 3);
  pilot.fly(2, kAir);
  CHECK(pilot.aircraft().forward_speed() == 0);
  CHECK(pilot.aircraft().phase() == Phase::hovering);
}

TEST_CASE(
    "at 0.4 m/s it stands a fifth of a second after it is told to hover: with 12 degrees it brakes with 2.1 m/s^2") {
  Pilot pilot;
  pilot.fly(2.5, kAir);
  pilot.fly(3, kAir, "1,0,-1106737239,0,0");  // pitch -0.1333
  CHECK(pilot.aircraft().forward_speed() == doctest::Approx(0.4).epsilon(0.02));
  pilot.fly(0.1, kAir);
  CHECK(pilot.aircraft().forward_speed() > 0.1);
  pilot.fly(0.12, kAir);
  CHECK(pilot.aircraft().forward_speed() == 0);
}

TEST_CASE("a number that does not rise is ignored; 1 is a client that has started anew") {
  Pilot pilot;
  pilot.raw("AT*REF=500," + kAir + "\r");
  pilot.raw("AT*REF=500," + kGround + "\r");
  pilot.raw("AT*REF=499," + kGround + "\r");
  CHECK(pilot.aircraft().phase() == Phase::taking_off);
  CHECK(pilot.said("ignored REF 499 after 500"));
  pilot.raw("AT*REF=1," + kGround + "\r");
  CHECK(pilot.aircraft().phase() == Phase::landing);
  pilot.raw("AT*REF=2," + kAir + "\r");
  CHECK(pilot.aircraft().phase() == Phase::taking_off);
}

TEST_CASE("comWatchdog comes after 50 ms, communicationLost after 2 s; COMWDG clears both") {
  Pilot pilot;
  pilot.send("COMWDG");
  pilot.pass(0.04);
  CHECK((pilot.state() & (bits::kComWatchdog | bits::kComLost)) == 0);
  pilot.pass(0.02);
  CHECK((pilot.state() & (bits::kComWatchdog | bits::kComLost)) == bits::kComWatchdog);
  pilot.send("REF", kGround);
  CHECK((pilot.state() & bits::kComWatchdog) != 0);  // traffic alone does not end it
  pilot.pass(1.95);
  CHECK((pilot.state() & bits::kComLost) == 0);
  pilot.pass(0.1);
  CHECK((pilot.state() & bits::kComLost) != 0);
  CHECK(pilot.said("communication lost"));
  pilot.send("COMWDG");
  CHECK((pilot.state() & (bits::kComWatchdog | bits::kComLost)) == 0);
}

TEST_CASE("after a silence it does not take off, nor obey in the air, until COMWDG") {
  for (const double silence : {0.3, 1.0, 2.5}) {
    CAPTURE(silence);
    Pilot pilot;
    pilot.send("COMWDG");
    pilot.pass(silence);
    pilot.sequence_ = std::max(pilot.sequence_, 7U);
    pilot.fly(0.1, kAir);
    CHECK(pilot.aircraft().phase() == Phase::landed);
    pilot.send("COMWDG");
    pilot.fly(3, kAir);
    CHECK(pilot.aircraft().phase() == Phase::hovering);
    pilot.fly(0.5, kAir, "1,0,-1085485875,0,0");
    pilot.pass(silence);
    CHECK(pilot.aircraft().phase() == Phase::hovering);
    pilot.fly(0.5, kAir, "1,0,-1085485875,0,0");
    CHECK(pilot.aircraft().phase() == Phase::hovering);
    pilot.send("COMWDG");
    pilot.fly(0.5, kAir, "1,0,-1085485875,0,0");
    CHECK(pilot.aircraft().phase() == Phase::flying);
  }
}

TEST_CASE("a client that is only late is obeyed, and the first one needs no COMWDG: nobody was lost") {
  Pilot pilot;
  pilot.pass(60);
  CHECK((pilot.state() & (bits::kComWatchdog | bits::kComLost)) == bits::kComWatchdog);
  pilot.send("REF", kAir);
  pilot.pass(0.2);
  pilot.send("REF", kGround);
  CHECK(pilot.aircraft().phase() == Phase::landing);
}

TEST_CASE("a lost client is told nothing until it wakes the drone again; without a command for 4 s it lands") {
  Pilot pilot;
  pilot.fly(2.5, kAir);
  CHECK(pilot.drone().tells());
  pilot.pass(2.1);
  CHECK(!pilot.drone().tells());
  CHECK(pilot.aircraft().phase() == Phase::hovering);
  pilot.pass(2);
  CHECK(pilot.aircraft().phase() == Phase::landing);
  pilot.drone().wake(false);
  CHECK(pilot.drone().tells());
  CHECK((pilot.state() & bits::kComLost) != 0);
}

TEST_CASE("emergency is toggled by the bit's edge: motors cut, and back on the ground") {
  Pilot pilot;
  pilot.fly(2.5, kAir);
  pilot.fly(1, kToggle);
  CHECK((pilot.state() & bits::kEmergency) != 0);
  CHECK(pilot.aircraft().altitude() == 0);
  pilot.fly(1, kAir);
  CHECK(pilot.aircraft().phase() == Phase::cut);
  pilot.fly(0.5, kGround);
  pilot.fly(0.1, kToggle);
  CHECK((pilot.state() & bits::kEmergency) == 0);
  CHECK(pilot.aircraft().phase() == Phase::landed);
}

TEST_CASE("a fault by word cuts the motors with its cause; clear gives them back") {
  Pilot pilot;
  pilot.fly(2.5, kAir);
  pilot.drone().fail_emergency();
  CHECK((pilot.state() & (bits::kEmergency | bits::kCutout)) == (bits::kEmergency | bits::kCutout));
  pilot.drone().clear_faults();
  CHECK((pilot.state() & (bits::kEmergency | bits::kCutout)) == 0);
}

TEST_CASE("the battery drains in the air, keeps it on the ground when low, and lands it when empty") {
  Pilot pilot;
  pilot.fly(3, kAir);
  CHECK(pilot.aircraft().battery() < 99.8);
  pilot.drone().set_battery(19);
  CHECK((pilot.state() & bits::kBatteryLow) != 0);
  pilot.fly(1, kAir);
  CHECK(pilot.aircraft().phase() == Phase::hovering);
  pilot.drone().set_battery(3);
  pilot.pass(0.1);
  CHECK(pilot.aircraft().phase() == Phase::landing);
  pilot.fly(3, kGround);
  pilot.fly(0.1, kAir);
  CHECK(pilot.aircraft().phase() == Phase::landed);
  CHECK(pilot.said("take_off_refused battery_low"));
}

TEST_CASE("a setting is acknowledged by a bit until it is put down; the flight is told once it was asked for") {
  Pilot pilot;
  CHECK((pilot.state() & bits::kBootstrap) != 0);
  CHECK(pilot.drone().navdata().size() == 24);
  pilot.send("CONFIG", "\"general:navdata_demo\",\"TRUE\"");
  CHECK((pilot.state() & (bits::kCommandTaken | bits::kBootstrap)) == bits::kCommandTaken);
  CHECK(pilot.drone().navdata().size() == 500);
  pilot.send("CTRL", "5,0");
  CHECK((pilot.state() & bits::kCommandTaken) == 0);
  pilot.drone().wake(false);
  CHECK(pilot.drone().navdata().size() == 500);
  pilot.drone().wake(true);
  CHECK(pilot.drone().navdata().size() == 24);
}

TEST_CASE("robot time runs faster, its watchdog does not") {
  Pilot pilot(10);
  pilot.fly(0.3, kAir);
  CHECK(pilot.aircraft().phase() == Phase::hovering);
  pilot.pass(1.9);
  CHECK((pilot.state() & bits::kComLost) == 0);
}

TEST_CASE("what is no command, or not for it, changes nothing and is said") {
  Pilot pilot;
  pilot.send("PCMD", "1,0,1090519040,0,0");  // 8.0
  pilot.send("PCMD", "1,0,2143289344,0,0");  // not a number
  pilot.send("REF", "x");
  pilot.send("CONFIG", "\"one\"");
  pilot.send("DANCE", "1");
  pilot.raw("\r\n\"");
  CHECK(pilot.said("rejected PCMD"));
  CHECK(pilot.said("rejected REF"));
  CHECK(pilot.said("rejected CONFIG"));
  CHECK(pilot.said("unknown DANCE 1"));
  CHECK(pilot.aircraft().phase() == Phase::landed);
}
