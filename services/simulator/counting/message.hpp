// A message of the paper's protocol, as it happens.
#pragma once

#include <array>
#include <cstdint>

#include "proto/phase.hpp"

namespace trb::counting {

/// Who sends and receives. A robot's middleware runs on the robot's own computer.
enum class Party : std::uint8_t { cloud, middleware, robot, device, everybody };

struct End {
  Party party = Party::cloud;
  std::uint32_t of = 0;  ///< the robot whose it is; of a device: its number
};

struct CountedMessage {
  double at_s = 0;
  CostPhase phase{};
  End from, to;
  std::uint64_t bytes = 0;
  [[nodiscard]] bool between_computers() const {
    return from.party != Party::robot && from.party != Party::device && to.party != Party::robot &&
           to.party != Party::device;
  }
};

/// The byte model: the datagram of Figure 3 (proto/figure3.hpp), a header of 32 bytes and the data.
struct Sizes {
  static constexpr std::uint64_t kHeader = 32;   ///< no data: "the data field is almost always empty" (section 6.2)
  static constexpr std::uint64_t kValue = 48;    ///< a value: the larger of the two sizes of section 6.2
  static constexpr std::uint64_t kToCloud = 52;  ///< "an acknowledgment is about 52 bytes" (section 6.2)
  /// Figure 4's fields of a task without data, one by one: type, subtype, source, size, and the end of an empty text.
  static constexpr std::array<std::uint64_t, 5> kFields{4, 8, 8, 4, 1};
};

}  // namespace trb::counting
