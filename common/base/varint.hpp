// Whole numbers in as many bytes as they need: seven bits in each, the lowest first, the eighth says that more follow.
#pragma once

#include <cstdint>

#include "common/base/bytes.hpp"

namespace trb {

inline void put_varint(Bytes& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7U) out += static_cast<char>(value | 0x80U);
  out += static_cast<char>(value);
}

/// Also below 0: what is near it takes few bytes.
inline void put_signed_varint(Bytes& out, std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  put_varint(out, value < 0 ? ~(bits << 1U) : bits << 1U);
}

/// Reads bytes from the front. What is cut or malformed reads as 0 or as nothing, and ok() is false from then on.
class VarintReader {
 public:
  explicit VarintReader(BytesView bytes) : rest_(bytes) {}

  std::uint64_t number() {
    std::uint64_t out = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const unsigned next = byte();
      const std::uint64_t bits = next & 0x7fU;
      if (shift == 63 && bits > 1) break;
      out |= bits << shift;
      if (next < 0x80) return ok_ ? out : 0;
    }
    ok_ = false;
    return 0;
  }
  std::int64_t signed_number() {
    const std::uint64_t bits = number();
    return static_cast<std::int64_t>((bits & 1U) != 0 ? ~(bits >> 1U) : bits >> 1U);
  }
  unsigned byte() {
    const BytesView one = bytes(1);
    return one.empty() ? 0 : static_cast<unsigned char>(one.front());
  }
  BytesView bytes(std::uint64_t size) {
    ok_ = ok_ && size <= rest_.size();
    if (!ok_) return {};
    const BytesView out = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return out;
  }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  BytesView rest_;
  bool ok_ = true;
};

}  // namespace trb
