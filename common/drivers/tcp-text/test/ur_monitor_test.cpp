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
        with_length("\x10" + std::string("\x7f\xff\xff\xff\0", 5)), with_length("\x10" + with_length("\0"))}) {
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
