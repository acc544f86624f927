#include "services/virtual-robots/pioneer/packet.hpp"

#include <doctest/doctest.h>

using namespace trb::virtual_robots::pioneer;

namespace {

std::string bytes(std::initializer_list<int> values) {
  std::string out;
  for (const int value : values) out += static_cast<char>(value);
  return out;
}

const std::string kStop = bytes({0xfa, 0xfb, 3, 29, 0, 29});
const std::string kBackwards = bytes({0xfa, 0xfb, 6, 11, 0x1b, 200, 0, 0xd3, 0x1b});

}  // namespace

TEST_CASE("packet: the golden bytes of the echoes") {
  CHECK(PacketWriter(0).packet() == bytes({0xfa, 0xfb, 3, 0, 0, 0}));
  CHECK(PacketWriter(1).packet() == bytes({0xfa, 0xfb, 3, 1, 0, 1}));
  // 0241 + 0042 + 0000 = 0283, and the odd last byte xor-ed in
  CHECK(PacketWriter(2).text("A").text("B").text("").packet() == bytes({0xfa, 0xfb, 8, 2, 'A', 0, 'B', 0, 0, 2, 0x83}));
  CHECK(PacketWriter(0x32).word(-2).packet() == bytes({0xfa, 0xfb, 5, 0x32, 0xfe, 0xff, 0x32 + 0, 0x01}));
}

TEST_CASE("packet: commands come out whole, however they come in") {
  CommandReader reader;
  std::vector<Command> commands;
  for (const char c : "noise\xfa" + kStop + kBackwards) {
    for (const Command& command : reader.add(std::string(1, c))) commands.push_back(command);
  }
  REQUIRE(commands.size() == 2);
  CHECK(commands[0].number == 29);
  CHECK_FALSE(commands[0].value);
  CHECK(commands[1].number == 11);
  CHECK(commands[1].value == -200);
}

TEST_CASE("packet: a string has its length before it") {
  const std::string contents = bytes({42, 0x2b, 3, 'a', '"', '\n'});
  std::string packet = bytes({0xfa, 0xfb, 8}) + contents;
  const int sum = checksum_of(contents);
  const auto commands = CommandReader().add(packet + bytes({sum >> 8, sum & 0xff}));
  REQUIRE(commands.size() == 1);
  CHECK(commands[0].text == "a\"\n");
}

TEST_CASE("packet: a wrong checksum costs that packet alone") {
  CommandReader reader;
  std::string broken = kBackwards;
  broken[5] = 7;
  const auto commands = reader.add(broken + kStop);
  REQUIRE(commands.size() == 1);
  CHECK(commands[0].number == 29);
  CHECK(reader.take_wrong() == 1);
  CHECK(reader.take_wrong() == 0);
}
