#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::drone {

/** `AT*NAME=SEQUENCE,ARGUMENT,...`; a text argument is stored without its quotes. */
struct Command {
  std::string name;
  std::uint32_t sequence = 0;
  std::vector<std::string> arguments;
};

/** The longest datagram that the drone accepts. */
constexpr std::size_t kLongestDatagram = 1024;

struct Datagram {
  std::vector<Command> commands;
  std::vector<std::string> rejected;  ///< lines that are not commands
};

/** The commands of one datagram, each ended by a carriage return. */
Datagram parse_datagram(std::string_view bytes);

std::optional<std::int32_t> integer_argument(const Command& command, std::size_t index);

/** A float that was written as the int32 of the same bits; nothing if it is not finite. */
std::optional<float> float_argument(const Command& command, std::size_t index);

}  // namespace trb::virtual_robots::drone
