#pragma once

#include <array>
#include <cstdint>

namespace trb::virtual_robots::ur {

/** General purpose registers: a client and a program exchange numbers by them. */
struct Registers {
  static constexpr int kNumbers = 48;
  static constexpr int kBits = 128;

  std::array<std::int32_t, kNumbers> integers{};
  std::array<double, kNumbers> doubles{};
  std::array<std::uint32_t, kBits / 32> bits{};

  bool bit(int index) const { return ((bits[static_cast<std::size_t>(index / 32)] >> (index % 32)) & 1) != 0; }
  void set_bit(int index, bool on) {
    std::uint32_t& word = bits[static_cast<std::size_t>(index / 32)];
    const std::uint32_t mask = std::uint32_t{1} << (index % 32);
    word = on ? word | mask : word & ~mask;
  }
};

}  // namespace trb::virtual_robots::ur
