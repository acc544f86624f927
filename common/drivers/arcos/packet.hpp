// ARCOS packets, to and from a robot: FA FB, the number of bytes that follow, a type, contents, a checksum.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/bytes.hpp"

namespace trb::drivers {

struct ArcosPacket {
  std::uint8_t type = 0;
  Bytes contents;
};

/// The sum of the big-endian pairs between count and checksum, modulo 2^16; an odd last byte is xor-ed into it.
std::uint16_t arcos_checksum(BytesView bytes);

Bytes arcos_command(std::uint8_t number);
/// -32767 to 65535: the sign is in the argument's type.
Bytes arcos_command(std::uint8_t number, int argument);
/// At most 200 bytes; its length precedes it, so that it may contain any byte.
Bytes arcos_command(std::uint8_t number, BytesView text);

constexpr std::size_t kMaxArcosText = 200;

/// Cuts a stream into packets. After invalid bytes it continues at the next FA FB.
class ArcosReader {
 public:
  void add(BytesView bytes, std::vector<ArcosPacket>& out);
  void clear() { *this = {}; }

  /// Since the last call.
  struct Losses {
    std::size_t garbage = 0;  ///< bytes that belonged to no packet
    std::size_t wrong = 0;    ///< packets whose checksum was wrong
  };
  Losses take_losses();

 private:
  /// Drops what precedes the next header. True if the buffer may hold another packet; false: no header yet, or nothing
  /// after it.
  bool begins_with_header();
  bool take_one(std::vector<ArcosPacket>& out);
  void drop(std::size_t size);

  Bytes buffer_;
  Losses losses_;
};

}  // namespace trb::drivers
