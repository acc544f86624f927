#include "services/virtual-robots/ur/packets.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "services/virtual-robots/ur/events.hpp"

using namespace trb::virtual_robots::ur;

namespace {

constexpr std::uint64_t kTime = 0x0102030405060708;

std::string hex(std::string_view bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const char c : bytes) {
    out += kDigits[(static_cast<unsigned char>(c) >> 4) & 0xf];
    out += kDigits[static_cast<unsigned char>(c) & 0xf];
  }
  return out;
}

}  // namespace

TEST_CASE("version packet: the golden bytes") {
  CHECK(hex(version_packet()) ==
        "00000037"
        "14"
        "ffffffffffffffff"
        "fe"
        "03"
        "09"
        "5552436f6e74726f6c"
        "050c"
        "00000000"
        "00000000"
        "30312d30312d323032322c2030303a30303a3030");
}

TEST_CASE("robot state packet: mode and joints, one behind the other") {
  RobotState state;
  state.mode = RobotMode::running;
  state.safety = SafetyMode::protective_stop;
  state.program_running = true;
  state.joints.position = {1.0, 2.0, 0, 0, 0, 0};
  state.joints.speed = {0.5, 0, 0, 0, 0, 0};
  const std::string bytes = robot_state_packet(state, kTime);
  REQUIRE(bytes.size() == 5 + 47 + 251 + 37 + 75 + 101 + 225 + 445 + 61 + 9 + 53 + 43 + 26 + 8);
  CHECK(hex(bytes.substr(0, 5)) == "0000056a10");
  CHECK(hex(bytes.substr(5, 47)) ==
        "0000002f"
        "00"
        "0102030405060708"
        "01010100010100"
        "07"
        "00"
        "3ff00000000000003ff00000000000003ff0000000000000"
        "00");
  CHECK(hex(bytes.substr(52, 5 + 41)) ==
        "000000fb"
        "01"
        "3ff00000000000003ff00000000000003fe0000000000000"
        "000000004240000041f0000000000000"
        "fd");
  CHECK(hex(bytes.substr(57 + 41, 8)) == "4000000000000000");
}

TEST_CASE("robot state packet: emergency stop, power off") {
  RobotState state;
  state.mode = RobotMode::power_off;
  state.safety = SafetyMode::emergency_stop;
  const std::string bytes = robot_state_packet(state, 0);
  CHECK(hex(bytes.substr(18, 8)) == "0101000100000003");
  CHECK(static_cast<unsigned char>(bytes[57 + 40]) == 239);
}

TEST_CASE("robot state packet: thirteen parts, walked by their lengths, with the sizes of the maker's table") {
  RobotState state;
  state.io.outputs = 0x10005;
  state.tool.values[2] = 0.1;
  const std::string bytes = robot_state_packet(state, 0);
  std::vector<std::size_t> sizes;
  for (std::size_t at = 5; at < bytes.size(); at += sizes.back()) {
    REQUIRE(hex(bytes.substr(at + 4, 1)) == hex(std::string(1, static_cast<char>(sizes.size()))));
    sizes.push_back(std::stoul(hex(bytes.substr(at, 4)), nullptr, 16));
  }
  CHECK(sizes == std::vector<std::size_t>{47, 251, 37, 75, 101, 225, 445, 61, 9, 53, 43, 26, 8});
  CHECK(hex(bytes.substr(5 + 47 + 251 + 37 + 5, 8)) == "0000000000010005");  // inputs, outputs
  const std::size_t cartesian = 5 + 47 + 251 + 37 + 75;
  CHECK(hex(bytes.substr(cartesian + 5 + 64, 8)) == "3fb999999999999a");  // the tool's z
}

TEST_CASE("key packet: the golden bytes") {
  CHECK(hex(key_packet("PROGRAM_XXX_STARTED", "pick", kTime)) ==
        "0000002f"
        "14"
        "0102030405060708"
        "fe"
        "07"
        "00000000"
        "00000000"
        "13"
        "50524f4752414d5f5858585f53544152544544"
        "7069636b");
}

TEST_CASE("exception packet: the golden bytes") {
  CHECK(hex(exception_packet({2, 3, "ab:"}, kTime)) ==
        "0000001a"
        "14"
        "0102030405060708"
        "fd"
        "0a"
        "00000002"
        "00000003"
        "61623a");
}

TEST_CASE("error, safety and text packets: the golden bytes") {
  CHECK(hex(error_packet(100, -1, ErrorLevel::violation, "x", kTime)) ==
        "00000024140102030405060708fd0600000064ffffffff00000003000000000000000078");
  CHECK(hex(safety_packet(SafetyMode::protective_stop, kTime)) ==
        "00000020140102030405060708fd0500000000000000000300000000"
        "00000000");
  CHECK(hex(text_packet("hi", kTime)) == "00000011140102030405060708fd006869");
}

TEST_CASE("events: their lines are one line each") {
  CHECK(line_of(ProgramStarted{"pick"}) == "program pick started");
  CHECK(line_of(MoveStarted{{"movej", Joints{0, -1.5, 1, 0, 0, 0.25}, 0, 0}}) ==
        "move movej 0.0000 -1.5000 1.0000 0.0000 0.0000 0.2500");
  CHECK(line_of(TextSaid{"two\nlines"}) == "text two\\nlines");
  CHECK(line_of(ScriptRefused{{2, 3, "compile_error_name_not_found:x:"}}) ==
        "script_error 2 3 compile_error_name_not_found:x:");
}
