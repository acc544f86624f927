#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace trb::virtual_robots::ur {

/** Appends numbers in network order. */
class Bytes {
 public:
  Bytes& u8(std::uint8_t value) { return put(value, 1); }
  Bytes& u16(std::uint16_t value) { return put(value, 2); }
  Bytes& u32(std::uint32_t value) { return put(value, 4); }
  Bytes& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }
  Bytes& u64(std::uint64_t value) { return put(value, 8); }
  Bytes& f32(float value) { return u32(std::bit_cast<std::uint32_t>(value)); }
  Bytes& f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
  template <typename Array>
  Bytes& each_f64(const Array& values) {
    for (const double value : values) f64(value);
    return *this;
  }
  Bytes& text(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  Bytes& zeros(std::size_t count) {
    bytes_.append(count, '\0');
    return *this;
  }

  const std::string& str() const { return bytes_; }
  /** The bytes preceded by their length, which includes itself. */
  std::string with_length() const { return Bytes().u32(static_cast<std::uint32_t>(bytes_.size() + 4)).bytes_ + bytes_; }

 private:
  Bytes& put(std::uint64_t value, int count) {
    for (int shift = 8 * (count - 1); shift >= 0; shift -= 8) bytes_ += static_cast<char>((value >> shift) & 0xff);
    return *this;
  }

  std::string bytes_;
};

}  // namespace trb::virtual_robots::ur
