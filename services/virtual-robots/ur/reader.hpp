#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace trb::virtual_robots::ur {

/** Reads numbers in network order; past the end everything is zero and ok() is false. */
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && bytes_.empty(); }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  double f64() { return std::bit_cast<double>(number(8)); }
  std::string_view text(std::size_t count) { return take(count); }
  std::string_view rest() { return take(bytes_.size()); }

 private:
  std::string_view take(std::size_t count) {
    ok_ = ok_ && count <= bytes_.size();
    const std::string_view taken = ok_ ? bytes_.substr(0, count) : std::string_view();
    bytes_.remove_prefix(taken.size());
    return taken;
  }
  std::uint64_t number(std::size_t count) {
    std::uint64_t value = 0;
    for (const char byte : take(count)) value = (value << 8) | static_cast<unsigned char>(byte);
    return value;
  }

  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace trb::virtual_robots::ur
