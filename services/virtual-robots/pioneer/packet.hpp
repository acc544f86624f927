#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::pioneer {

/** A client's command: a number and, if it has one, an argument. */
struct Command {
  int number = 0;
  std::optional<int> value;         ///< of an integer, with its sign
  std::optional<std::string> text;  ///< of a string
};

/** Collects the contents of one packet; numbers are little-endian. */
class PacketWriter {
 public:
  explicit PacketWriter(int type) { byte(type); }
  PacketWriter& byte(int value);
  PacketWriter& word(int value);
  /** Followed by a zero byte. */
  PacketWriter& text(std::string_view value);
  /** FA FB, the count, the contents, the checksum with its high byte first. */
  std::string packet() const;

 private:
  std::string bytes_;
};

/** Splits a client's bytes into commands. Bytes between packets and packets with a wrong checksum are dropped. */
class CommandReader {
 public:
  std::vector<Command> add(std::string_view bytes);
  /** Packets with a wrong checksum since the last call. */
  int take_wrong();

 private:
  std::string kept_;
  int wrong_ = 0;
};

int checksum_of(std::string_view contents);

}  // namespace trb::virtual_robots::pioneer
