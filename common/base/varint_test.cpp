#include "common/base/varint.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace trb;

TEST_CASE("numbers come back, and small ones take one byte") {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint64_t value : {std::uint64_t{0}, std::uint64_t{127}, std::uint64_t{128}, kLargest - 1, kLargest}) {
    Bytes bytes;
    put_varint(bytes, value);
    VarintReader reader(bytes);
    CHECK(reader.number() == value);
    CHECK(reader.ok());
    CHECK(reader.at_end());
    CHECK(bytes.size() == (value < 128 ? 1 : value == 128 ? 2 : 10));
  }
}

TEST_CASE("numbers below 0 come back, and those near it take one byte") {
  using Limits = std::numeric_limits<std::int64_t>;
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{63}, std::int64_t{-64},
                                   std::int64_t{64}, Limits::min(), Limits::max()}) {
    Bytes bytes;
    put_signed_varint(bytes, value);
    VarintReader reader(bytes);
    CHECK(reader.signed_number() == value);
    CHECK(reader.at_end());
    CHECK((bytes.size() == 1) == (value >= -64 && value < 64));
  }
}

TEST_CASE("what is cut, or has more than 64 bits, is no number") {
  const Bytes cut("\x80\x80", 2);
  const Bytes longer(11, '\x80');
  const Bytes large = Bytes(9, '\xff') + '\x02';
  for (const BytesView bytes : {BytesView{}, BytesView(cut), BytesView(longer), BytesView(large)}) {
    VarintReader reader(bytes);
    CHECK(reader.number() == 0);
    CHECK_FALSE(reader.ok());
  }
}

TEST_CASE("what is behind a number is left; nothing is read behind a fault") {
  VarintReader reader(
      "\x05"
      "abc");
  CHECK(reader.number() == 5);
  CHECK(reader.bytes(2) == "ab");
  CHECK(reader.bytes(2).empty());
  CHECK_FALSE(reader.ok());
  CHECK(reader.bytes(1).empty());
  CHECK_FALSE(reader.at_end());
}
