// Choices out of any bytes, for targets that build something mostly valid.
#pragma once

#include <cstddef>
#include <string>

#include "common/base/bytes.hpp"

namespace trb::fuzz {

/// Reads the input byte by byte; 0 when it is used up.
class Bits {
 public:
  explicit Bits(BytesView input) : input_(input) {}
  [[nodiscard]] bool empty() const { return input_.empty(); }
  std::size_t below(std::size_t count) {
    if (input_.empty()) return 0;
    const auto byte = static_cast<unsigned char>(input_.front());
    input_.remove_prefix(1);
    return byte % count;
  }
  /// Mostly true.
  bool mostly() { return below(8) != 7; }
  template <class T, std::size_t N>
  T one_of(const T (&choices)[N]) {
    return choices[below(N)];
  }
  [[nodiscard]] std::string rest() const { return std::string(input_); }

 private:
  BytesView input_;
};

}  // namespace trb::fuzz
