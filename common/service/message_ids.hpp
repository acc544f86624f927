// The ids of what a connection of the bus sends.
#pragma once

#include <array>
#include <cstdint>

namespace trb {

/// An id: the slot that the router gave (16 bits), 32 random bits that nobody guesses, so that nobody answers in
/// another's place, and a count (16 bits), by which the router's table of what is asked is kept.
class MessageIds {
 public:
  std::uint64_t next(std::uint16_t slot);

 private:
  std::array<std::uint32_t, 256> random_{};  ///< drawn together: no call of the system for each message
  std::size_t used_ = 256;
  std::uint16_t count_ = 0;
};

}  // namespace trb
