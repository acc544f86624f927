// Golden bytes of a UR controller's primary interface, as measured.
#include "common/drivers/tcp-text/ur_monitor.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "common/base/hex.hpp"
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

std::vector<UrEvent> events_of(BytesView bytes, std::size_t step = 1000) {
  UrMonitor monitor;
  std::vector<UrEvent> events;
  for (std::size_t at = 0; at < bytes.size(); at += step) CHECK(monitor.add(bytes.substr(at, step), events));
  return events;
}

const std::string kStarted = *from_hex(
    "0000002f140102030405060708fd070000000000000000"
    "1350524f4752414d5f5858585f535441525445447069636b");
const std::string kException = *from_hex("0000001a140102030405060708fd0a000000020000000361623a");

}  // namespace

TEST_CASE("a key message names the program that has started") {
  const auto events = events_of(kStarted);
  REQUIRE(events.size() == 1);
  CHECK(std::get<UrProgramStarted>(events[0]).name == "pick");
}

TEST_CASE("an exception has line, column and text, also byte by byte") {
  const auto events = events_of(kException, 1);
  REQUIRE(events.size() == 1);
  const auto& raised = std::get<UrException>(events[0]);
  CHECK(raised.line == 2);
  CHECK(raised.column == 3);
  CHECK(raised.text == "ab:");
}

TEST_CASE("a state has mode, safety and joints; parts and packets that are not known are skipped") {
  const std::string mode = *from_hex(
      "0000002f00010203040506070801010100010100"
      "07003ff00000000000003ff00000000000003ff000000000000000");
  std::string joints;
  for (const char* q : {"3ff0000000000000", "bff0000000000000", "0000000000000000", "0000000000000000",
                        "0000000000000000", "4000000000000000"}) {
    joints += *from_hex(q) + std::string(32, '\0') + '\xfd';
  }
  const std::string unknown_part = with_length("\x09" + std::string(20, 'x'));
  const std::string state = with_length("\x10" + unknown_part + mode + with_length("\x01" + joints));
  const std::string version = *from_hex("0000003714fffffffffffffffffe030955522d436f6e74726f6c") + std::string(29, 'v');
  const auto events = events_of(version + with_length("\x63" + std::string(9, 'y')) + state + kStarted, 7);
  REQUIRE(events.size() == 2);
  const auto& said = std::get<UrState>(events[0]);
  CHECK(said.robot_mode == 7);
  CHECK(said.safety == kUrSafetyProtectiveStop);
  CHECK(said.program_running);
  REQUIRE(said.joints);
  CHECK((*said.joints)[0] == 1.0);
  CHECK((*said.joints)[1] == -1.0);
  CHECK((*said.joints)[5] == 2.0);
}

TEST_CASE("an error report has its codes") {
  const auto events = events_of(*from_hex("00000024140102030405060708fd0600000064ffffffff00000003000000000000000078"));
  REQUIRE(events.size() == 1);
  const auto& error = std::get<UrError>(events[0]);
  CHECK(error.code == 100);
  CHECK(error.argument == -1);
  CHECK(error.level == 3);
  CHECK(error.text == "x");
}

TEST_CASE("packets with cut or lying contents are skipped, the next one is read") {
  for (const std::string& broken :
       {with_length("\x14"), with_length("\x14" + std::string(9, '\1')), ur_message(7, "\1\2\3"),
        ur_message(7, std::string(8, '\0') + "\xffshort"), ur_message(10, "\1"), ur_message(6, "\1\2"),
        with_length("\x10"), with_length("\x10" + std::string("\0\0\0\1\0", 5)),
        with_length("\x10" + std::string("\x7f\xff\xff\xff\0", 5)),
        with_length("\x10" + with_length(std::string(1, '\0')))}) {
    const auto events = events_of(broken + kStarted);
    REQUIRE(events.size() == 1);
    CHECK(std::holds_alternative<UrProgramStarted>(events[0]));
  }
}

TEST_CASE("joints that no axis can turn are no joints; the rest of the state is read") {
  for (const double joint : {1e300, -1e4, std::numeric_limits<double>::quiet_NaN()}) {
    UrPicture picture;
    picture.joint = joint;
    const auto events = events_of(ur_state(picture));
    REQUIRE(events.size() == 1);
    CHECK_FALSE(std::get<UrState>(events[0]).joints);
    CHECK(std::get<UrState>(events[0]).robot_mode == 7);
  }
}

TEST_CASE("a length that cannot be ends the stream") {
  std::vector<UrEvent> events;
  CHECK(UrMonitor().add(*from_hex("0000000414"), events).error().code == Errc::malformed);
  CHECK(UrMonitor().add(*from_hex("0001000114"), events).error().code == Errc::too_large);
  CHECK(UrMonitor().add(*from_hex("ffffffff14"), events).error().code == Errc::too_large);
  CHECK(events.empty());
}

TEST_CASE("a state tells power, speed, the tool's place, and how far the arm reaches by its calibration") {
  const auto real = [](double value) { return big_endian(std::bit_cast<std::uint64_t>(value), 8); };
  std::string mode =
      big_endian(0, 1) + std::string(8, '\1') + std::string("\1\1\1\0\0\0\0\7\0", 9) + real(0.25) + real(1) + real(1);
  std::string cartesian = big_endian(4, 1);
  for (const double value : {0.1, 0.2, 0.3, 0.0, 3.14, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0}) cartesian += real(value);
  std::string kinematics = big_endian(5, 1) + std::string(24, '\0');
  for (int i = 0; i < 6; ++i) kinematics += real(0);
  for (const double a : {0.0, -0.24365, -0.21325, 0.0, 0.0, 0.0}) kinematics += real(a);
  for (const double d : {0.1519, 0.0, 0.0, 0.11235, 0.08535, 0.0819}) kinematics += real(d);
  for (int i = 0; i < 6; ++i) kinematics += real(0);
  const auto packet = [&](const std::string& last) {
    return with_length(big_endian(16, 1) + with_length(mode) + with_length(cartesian) + with_length(last));
  };
  const UrState state = std::get<UrState>(events_of(packet(kinematics + big_endian(0, 4))).at(0));
  CHECK(state.power);
  CHECK(state.speed_fraction == 0.25);
  REQUIRE(state.tool);
  CHECK((*state.tool)[2] == 0.3);
  REQUIRE(state.reach);
  CHECK(state.reach->shoulder_height == 0.1519);
  CHECK(state.reach->length == doctest::Approx(0.607 + 0.1).epsilon(0.01));
  CHECK_FALSE(std::get<UrState>(events_of(packet(kinematics.substr(0, 100))).at(0)).reach);
}
