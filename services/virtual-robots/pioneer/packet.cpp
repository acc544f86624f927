#include "services/virtual-robots/pioneer/packet.hpp"

#include <utility>

namespace trb::virtual_robots::pioneer {
namespace {

constexpr int kPositive = 0x3b;
constexpr int kNegative = 0x1b;
constexpr int kString = 0x2b;

int at(std::string_view bytes, std::size_t index) {
  return static_cast<unsigned char>(bytes[index]);
}

Command command_of(std::string_view contents) {
  Command command;
  command.number = at(contents, 0);
  const int type = contents.size() > 1 ? at(contents, 1) : 0;
  if ((type == kPositive || type == kNegative) && contents.size() >= 4) {
    const int size = at(contents, 2) | at(contents, 3) << 8;
    // An argument is a signed word: a positive one beyond 32767 comes out negative, as on the robot.
    command.value = type == kNegative ? -size : static_cast<std::int16_t>(size);
  }
  if (type == kString && contents.size() >= 3) command.text = contents.substr(3, at(contents, 2));
  return command;
}

}  // namespace

int checksum_of(std::string_view contents) {
  int sum = 0;
  while (contents.size() > 1) {
    sum = (sum + at(contents, 0) * 256 + at(contents, 1)) & 0xffff;
    contents.remove_prefix(2);
  }
  return contents.empty() ? sum : sum ^ at(contents, 0);
}

PacketWriter& PacketWriter::byte(int value) {
  bytes_ += static_cast<char>(value & 0xff);
  return *this;
}

PacketWriter& PacketWriter::word(int value) {
  return byte(value).byte(value >> 8);
}

PacketWriter& PacketWriter::text(std::string_view value) {
  bytes_ += value;
  return byte(0);
}

std::string PacketWriter::packet() const {
  const int sum = checksum_of(bytes_);
  std::string out = "\xfa\xfb";
  out += static_cast<char>(bytes_.size() + 2);
  out += bytes_;
  out += static_cast<char>(sum >> 8);
  out += static_cast<char>(sum & 0xff);
  return out;
}

std::vector<Command> CommandReader::add(std::string_view bytes) {
  std::vector<Command> commands;
  kept_ += bytes;
  std::size_t begin = 0;
  while (kept_.size() - begin >= 3) {
    const std::string_view rest = std::string_view(kept_).substr(begin);
    const std::size_t size = static_cast<std::size_t>(at(rest, 2)) + 3;
    if (at(rest, 0) != 0xfa || at(rest, 1) != 0xfb || size < 6) {
      ++begin;
      continue;
    }
    if (rest.size() < size) break;
    const std::string_view contents = rest.substr(3, size - 5);
    const bool good = checksum_of(contents) == at(rest, size - 2) * 256 + at(rest, size - 1);
    if (good) commands.push_back(command_of(contents));
    if (!good) ++wrong_;
    begin += good ? size : 2;
  }
  kept_.erase(0, begin);
  return commands;
}

int CommandReader::take_wrong() {
  return std::exchange(wrong_, 0);
}

}  // namespace trb::virtual_robots::pioneer
