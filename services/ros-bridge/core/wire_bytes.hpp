// Little-endian numbers in a message on the wire, on machines of either byte order.
#pragma once

#include <cstdint>
#include <type_traits>

#include "common/base/bytes.hpp"

namespace trb::ros {

template <class U>
void put_little(Bytes& out, U number) {
  static_assert(std::is_unsigned_v<U>);
  for (std::size_t i = 0; i < sizeof(U); ++i) out.push_back(static_cast<char>(number >> (8 * i)));
}

/// The first sizeof(U) bytes, which must be there.
template <class U>
U get_little(BytesView bytes) {
  static_assert(std::is_unsigned_v<U>);
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < sizeof(U); ++i) {
    number |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return static_cast<U>(number);
}

}  // namespace trb::ros
