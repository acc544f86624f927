#include "common/drivers/text/number_text.hpp"

#include <array>
#include <cstdio>

namespace trb::drivers {

std::string number_text(double number) {
  std::array<char, 40> text{};
  const int size = std::snprintf(text.data(), text.size(), "%.10g", number);
  return {text.data(), static_cast<std::size_t>(size)};
}

}  // namespace trb::drivers
