#include "common/base/number_text.hpp"

#include <doctest/doctest.h>

#include <cstdint>

using namespace trb;

TEST_CASE("a number is the whole text, within the type's range") {
  CHECK(parse_number<std::uint16_t>("45000") == 45000);
  CHECK(parse_number<int>("-7") == -7);
  CHECK(parse_number<double>("0.5") == 0.5);
  for (const char* none : {"", " 1", "1 ", "+1", "1x", "x", "-", "0x10", "65536", "-1"}) {
    CHECK_FALSE(parse_number<std::uint16_t>(none));
  }
}

TEST_CASE("a hexadecimal number is the whole text, without a prefix") {
  CHECK(parse_hex_number<std::uint8_t>("fF") == 255);
  CHECK(parse_hex_number<std::uint16_t>("0100") == 256);
  for (const char* none : {"", "0x1", " 1", "g", "100", "+1"}) CHECK_FALSE(parse_hex_number<std::uint8_t>(none));
}
