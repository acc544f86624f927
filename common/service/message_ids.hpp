// The ids of messages that a bus connection sends.
#pragma once

#include <array>
#include <cstdint>

namespace trb {

/// An id: the slot that the router gave (16 bits), 32 random bits so that no other service can guess an id and answer
/// it, and a count (16 bits), by which the router keeps its table of requests.
class MessageIds {
 public:
  std::uint64_t next(std::uint16_t slot);

 private:
  std::array<std::uint32_t, 256> random_{};  ///< drawn together, to save a system call for each message
  std::size_t used_ = 256;
  std::uint16_t count_ = 0;
};

}  // namespace trb
