#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace trb::virtual_robots::drone {

/** Little-endian bytes. */
class Packet {
 public:
  Packet& u8(std::uint32_t value) { return add(value, 1); }
  Packet& u16(std::uint32_t value) { return add(value, 2); }
  Packet& u32(std::uint32_t value) { return add(value, 4); }
  Packet& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }
  Packet& f32(double value) { return u32(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  Packet& zeros(std::size_t count) {
    bytes_.append(count, '\0');
    return *this;
  }
  Packet& bytes(const std::string& more) {
    bytes_ += more;
    return *this;
  }
  std::uint32_t sum() const {
    std::uint32_t total = 0;
    for (const char byte : bytes_) total += static_cast<unsigned char>(byte);
    return total;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  Packet& add(std::uint32_t value, int size) {
    for (; size > 0; --size, value >>= 8) bytes_ += static_cast<char>(value & 0xff);
    return *this;
  }

  std::string bytes_;
};

}  // namespace trb::virtual_robots::drone
